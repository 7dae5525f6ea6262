// SPDX-License-Identifier: Apache-2.0
// The body of the robot: that of its description, or a simple one until it comes. An arrow on the floor shows its front.

import { say } from "../shared/language.js";
import { BoxGeometry, BufferGeometry, CylinderGeometry, Group, Mesh, MeshBasicMaterial, Vector3 } from "../vendor/three.js";
import { RobotModel } from "../scene/robot_model.js";

const ARROW = [0.1, 0.7]; // metres before its foremost part: where it begins and ends
const ARROW_HALF_M = 0.18;
const SIMPLE_FRONT_M = 0.145;
const LARGEST_M = 5; // the arrow of a larger robot, or one whose description is out of its mind, begins here

/** The body, in the metres of the robot's frame. */
export class Body {
  object = new Group();
  /** Whether the description is shown. */
  isDescribed = false;
  #simple = new Group();
  #front;
  #model = null;
  #text = "";
  #root = new Group(); // the place of the description's root in the robot's frame

  /** @param {import("./room.js").Room} room */
  constructor(room) {
    const box = (colour, [length, width, height], [x, y, z]) => {
      const part = new Mesh(new BoxGeometry(length, width, height), room.material(colour));
      part.position.set(x, y, z);
      return part;
    };
    const mast = new Mesh(new CylinderGeometry(0.035, 0.035, 0.05, 24), room.material("quiet"));
    mast.rotation.x = Math.PI / 2;
    mast.position.z = 0.16;
    this.#simple.add(
      box("warning", [0.24, 0.22, 0.1], [0, 0, 0.08]),
      box("line", [0.07, 0.03, 0.07], [0, 0.13, 0.035]),
      box("line", [0.07, 0.03, 0.07], [0, -0.13, 0.035]),
      box("accent", [0.03, 0.1, 0.04], [0.13, 0, 0.1]), // its nose
      mast,
    );
    const [from, to] = ARROW;
    // seen from above
    const corners = [[from, ARROW_HALF_M], [from + 0.12, 0], [from, -ARROW_HALF_M], [to, 0]].map(([x, y]) => new Vector3(x, y, 0.012));
    const shape = new BufferGeometry().setFromPoints([0, 1, 3, 3, 1, 2].map((at) => corners[at]));
    this.#front = new Mesh(shape, room.material("series-4", MeshBasicMaterial));
    this.#front.position.x = SIMPLE_FRONT_M;
    this.object.add(this.#simple, this.#front, this.#root);
  }

  /** The frame of the description's root, or "". */
  get root() {
    return this.#model?.root ?? "";
  }

  /** The place where the arrow begins: the foremost part of the body, in metres. */
  get front() {
    return this.#front.position.x;
  }

  /** Why a part of the description is not shown, in words, or "". */
  get problem() {
    return this.#model?.problems[0] ? say("lab.part", { why: this.#model.problems[0] }) : "";
  }

  /**
   * Take a description of the robot.
   * @param {import("../shared/gateway.js").Gateway} gateway
   * @param {string} text the URDF
   */
  describe(gateway, text) {
    if (text === this.#text) return; // latched messages come again
    const model = new RobotModel(gateway, text, () => this.#reach());
    this.#text = text;
    this.#model?.close();
    this.#model = model;
    this.#root.add(model.object);
    this.isDescribed = true;
    this.#simple.visible = false;
    this.#reach();
  }

  /** Take where the root is in the robot's frame: a `translation` and a `rotation`, or null when nobody knows. Then they are one. */
  mount(transform) {
    this.#root.position.copy(transform?.translation ?? { x: 0, y: 0, z: 0 });
    this.#root.quaternion.copy(transform?.rotation ?? { x: 0, y: 0, z: 0, w: 1 });
    this.#reach();
  }

  /** Take a `sensor_msgs/msg/JointState`. */
  move(message) {
    this.#model?.move(message);
  }

  /** Put the arrow before the foremost part. */
  #reach() {
    if (!this.#model) return;
    const { parent } = this.object;
    this.object.removeFromParent(); // its own metres, wherever it stands
    this.object.updateMatrixWorld(true);
    let foremost = -Infinity;
    this.#root.traverse(({ geometry, matrixWorld }) => {
      if (!geometry) return;
      geometry.computeBoundingBox();
      foremost = Math.max(foremost, geometry.boundingBox.clone().applyMatrix4(matrixWorld).max.x);
    });
    parent?.add(this.object);
    this.#front.position.x = Number.isFinite(foremost) ? Math.max(0, Math.min(LARGEST_M, foremost)) : SIMPLE_FRONT_M;
  }
}
