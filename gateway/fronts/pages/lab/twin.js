// SPDX-License-Identifier: Apache-2.0
// The digital twin: a body that stands where the odometry says, with what its laser sees.

import { BufferAttribute, BufferGeometry, DynamicDrawUsage, Group, LineBasicMaterial, LineSegments, Points, PointsMaterial, Vector3 } from "../vendor/three.js";
import { yawOf } from "../views/plan.js";
import { Body } from "./body.js";
import { asRos } from "./floor.js";

const MOST_POINTS = 4096; // of a scan. Further ones are not drawn

/** The robot, in its own metres. */
export class Twin {
  /** Its pose: metres and radians of the odometry's frame. */
  pose = { x: 0, y: 0, yaw: 0 };
  world = asRos(new Group());
  /** Its looks. @type {Body} */
  body;
  #body = new Group();
  #laser = new Group();
  #places = new BufferAttribute(new Float32Array(3 * MOST_POINTS), 3).setUsage(DynamicDrawUsage);
  #geometry = new BufferGeometry().setAttribute("position", this.#places);
  // from each point down to the floor: without them nobody sees which place of the map it stands on
  #ends = new BufferAttribute(new Float32Array(6 * MOST_POINTS), 3).setUsage(DynamicDrawUsage);
  #plumbs = new BufferGeometry().setAttribute("position", this.#ends);
  #down = new Vector3(); // to the floor, in the laser's frame

  /** @param {import("./room.js").Room} room */
  constructor(room) {
    this.body = new Body(room);
    this.#body.add(this.body.object, this.#laser);
    this.mount(null);
    this.#geometry.setDrawRange(0, 0);
    const points = new Points(this.#geometry, room.material("accent", PointsMaterial));
    points.material.size = 0.04;
    points.frustumCulled = false; // they are around the viewer
    const plumbs = new LineSegments(this.#plumbs, room.material("accent", LineBasicMaterial));
    Object.assign(plumbs.material, { transparent: true, opacity: 0.35 });
    plumbs.frustumCulled = false;
    this.#plumbs.setDrawRange(0, 0);
    this.#laser.add(points, plumbs);
    this.world.add(this.#body);
    room.scene.add(this.world);
  }

  /** Take a `nav_msgs/msg/Odometry`. */
  odometry({ pose: { pose: { position, orientation } } }) {
    this.pose.x = position.x;
    this.pose.y = position.y;
    this.pose.yaw = yawOf(orientation);
    this.#body.position.set(position.x, position.y, position.z);
    this.#body.quaternion.copy(orientation);
  }

  /** Take where the laser is on the robot: a `translation` and a `rotation`, or null when nobody knows. Then its scan is hidden. */
  mount(transform) {
    this.#laser.visible = transform !== null;
    if (!transform) return;
    this.#laser.position.copy(transform.translation);
    this.#laser.quaternion.copy(transform.rotation);
  }

  /** Take a `sensor_msgs/msg/LaserScan`. */
  scan({ ranges, angle_min: first, angle_increment: step, range_min: least, range_max: most }) {
    const { position, quaternion } = this.#laser;
    this.#down.set(0, 0, -(this.#body.position.z + position.z));
    const { x, y, z } = this.#down.applyQuaternion(quaternion.clone().invert());
    let count = 0;
    for (let at = 0; at < ranges.length && count < MOST_POINTS; at += 1) {
      const range = ranges[at];
      if (!(range >= least && range <= most)) continue;
      const [ahead, left] = [Math.cos(first + at * step) * range, Math.sin(first + at * step) * range];
      this.#places.setXYZ(count, ahead, left, 0);
      this.#ends.setXYZ(2 * count, ahead, left, 0);
      this.#ends.setXYZ(2 * count + 1, ahead + x, left + y, z);
      count += 1;
    }
    this.#places.needsUpdate = true;
    this.#ends.needsUpdate = true;
    this.#geometry.setDrawRange(0, count);
    this.#plumbs.setDrawRange(0, 2 * count);
  }

  /** How many points are drawn. */
  get points() {
    return this.#laser.visible ? this.#geometry.drawRange.count : 0;
  }
}
