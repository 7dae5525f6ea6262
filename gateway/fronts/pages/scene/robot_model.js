// SPDX-License-Identifier: Apache-2.0
// A robot of links and joints, made of its description. It is independent of the scene.

import { BoxGeometry, Color, CylinderGeometry, DoubleSide, Euler, Group, Mesh, MeshLambertMaterial, Quaternion, SphereGeometry, Vector3 } from "../vendor/three.js";
import { meshOf } from "./assets.js";
import { dispose } from "./display.js";
import { readUrdf } from "./urdf.js";

const GREY = [0.7, 0.72, 0.75, 1];
const TURNING = ["revolute", "continuous"];

/** The robot in the metres of its root link. */
export class RobotModel {
  object = new Group();
  /** The missing meshes, in words. @type {string[]} */
  problems = [];
  #joints = new Map(); // name -> {group, rest, axis, type, isMoving}
  #followers = []; // joints that mimic another one
  #isClosed = false;
  #turn = new Quaternion();

  /**
   * @param {import("../shared/gateway.js").Gateway} gateway
   * @param {string} text the URDF
   * @param {() => void} changed is called when a mesh has come
   */
  constructor(gateway, text, changed) {
    const { root, links, joints } = readUrdf(text);
    this.root = root;
    const groups = new Map([...links.keys()].map((name) => [name, new Group()]));
    this.object.add(groups.get(root));
    for (const joint of joints) {
      const group = groups.get(joint.child);
      place(group, joint);
      groups.get(joint.parent).add(group);
      const axis = new Vector3(...joint.axis).normalize();
      this.#joints.set(joint.name, { group, place: group.position.clone(), rest: group.quaternion.clone(), axis, type: joint.type, isMoving: false });
      if (joint.mimic) this.#followers.push({ ...joint.mimic, name: joint.name });
    }
    for (const [name, visuals] of links) for (const each of visuals) this.#show(gateway, groups.get(name), each, changed);
  }

  /** Take a `sensor_msgs/msg/JointState`. */
  move({ name, position }) {
    name.forEach((each, at) => this.#set(each, position[at]));
  }

  #set(name, value) {
    const joint = this.#joints.get(name);
    if (!joint || joint.isMoving || !Number.isFinite(value)) return; // joints may mimic each other
    joint.isMoving = true;
    if (TURNING.includes(joint.type)) joint.group.quaternion.copy(joint.rest).multiply(this.#turn.setFromAxisAngle(joint.axis, value));
    else if (joint.type === "prismatic") joint.group.position.copy(joint.axis).multiplyScalar(value).applyQuaternion(joint.rest).add(joint.place);
    for (const each of this.#followers) if (each.joint === name) this.#set(each.name, each.multiplier * value + each.offset);
    joint.isMoving = false;
  }

  close() {
    this.#isClosed = true;
    dispose(this.object);
    this.object.removeFromParent();
  }

  async #show(gateway, link, visual, changed) {
    const holder = new Group();
    place(holder, visual);
    link.add(holder);
    if (visual.kind !== "mesh") {
      const shape = shapeOf(visual);
      if (shape) holder.add(shape);
      return;
    }
    try {
      const [r, g, b, a] = visual.colour ?? [];
      const mesh = await meshOf(gateway, visual.uri, visual.colour && { r, g, b, a });
      holder.scale.set(...visual.size);
      if (this.#isClosed) dispose(mesh);
      else holder.add(mesh);
    } catch (error) {
      this.problems.push(error.message);
    }
    changed();
  }
}

function place(group, { xyz, rpy }) {
  const [roll, pitch, yaw] = rpy;
  group.position.set(...xyz);
  group.quaternion.setFromEuler(new Euler(roll, pitch, yaw, "ZYX")); // about x first, about z last
}

function shapeOf({ kind, size, colour }) {
  const shapes = {
    box: () => new BoxGeometry(...size),
    sphere: () => new SphereGeometry(size[0], 24, 16),
    cylinder: () => new CylinderGeometry(size[0], size[0], size[1], 32).rotateX(Math.PI / 2),
    capsule: () => new CylinderGeometry(size[0], size[0], size[1], 32).rotateX(Math.PI / 2),
  };
  if (!shapes[kind]) return null;
  const [r, g, b, a] = colour ?? GREY;
  return new Mesh(shapes[kind](), new MeshLambertMaterial({ color: new Color(r, g, b), opacity: a, transparent: a < 1, side: DoubleSide }));
}
