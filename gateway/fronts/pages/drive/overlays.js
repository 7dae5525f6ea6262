// SPDX-License-Identifier: Apache-2.0
// On the map of the drive page: the way of the robot so far, and its outline.

import { published } from "../shared/named_topics.js";
import { insist, yawOf } from "../views/plan.js";

const MOST_PLACES = 1000;
const LEAST_STEP = 0.05; // metres between two places of the trail
const RATE_HZ = 15; // of where the outline is
const HERE = { translation: { x: 0, y: 0 }, rotation: {} };

/** Draws the way of the robot on a map, as long as the page is open. */
export class Trail {
  #places = [];
  #frame = "";

  /** How many places it has. */
  get length() {
    return this.#places.length;
  }

  /**
   * Draw on a plan of a frame.
   * @param {import("../views/plan.js").Plan} plan
   * @param {string} frame
   * @param {{x: number, y: number}|null} robot
   */
  draw(plan, frame, robot) {
    if (frame !== this.#frame) this.#places = []; // they are of another map
    this.#frame = frame;
    const last = this.#places.at(-1);
    if (robot && (!last || Math.hypot(robot.x - last.x, robot.y - last.y) >= LEAST_STEP)) this.#places.push({ x: robot.x, y: robot.y });
    if (this.#places.length > MOST_PLACES) this.#places.shift();
    if (robot && this.#places.length) plan.line([...this.#places, robot]);
  }
}

/** Draws the outline of the robot, as Nav2 publishes it. */
export class Footprint {
  #gateway;
  #changed;
  #topic = "";
  #places = [];
  #source = "";
  #target = "";
  #transform = null; // from its frame to that of the map
  #end = () => {};

  /**
   * @param {import("../shared/gateway.js").Gateway} gateway
   * @param {() => void} changed is called when there is something else to draw
   */
  constructor(gateway, changed) {
    this.#gateway = gateway;
    this.#changed = changed;
  }

  /** Subscribe to it, once there is one. */
  look() {
    if (this.#topic) return;
    this.#topic = published(this.#gateway.graph, "footprint");
    if (this.#topic) this.#gateway.subscribe(this.#topic, { throttle_rate: 100 }, (message) => this.#take(message), () => {});
  }

  /** Draw on a plan of a frame. Return whether there is an outline. */
  draw(plan, frame) {
    if (frame !== this.#target) this.#follow(frame, this.#source);
    if (!this.#transform || this.#places.length < 3) return false;
    const { translation: { x, y }, rotation } = this.#transform;
    const yaw = yawOf(rotation);
    const placed = this.#places.map((each) => ({
      x: x + Math.cos(yaw) * each.x - Math.sin(yaw) * each.y, y: y + Math.sin(yaw) * each.x + Math.cos(yaw) * each.y,
    }));
    plan.line([...placed, placed[0]], "warning");
    return true;
  }

  #take({ header, polygon: { points } }) {
    for (const { x, y } of points) insist(x, y);
    this.#places = points;
    if (header.frame_id !== this.#source) this.#follow(this.#target, header.frame_id);
    this.#changed();
  }

  #follow(target, source) {
    this.#end();
    this.#end = () => {};
    [this.#target, this.#source] = [target, source];
    this.#transform = target && target === source ? HERE : null;
    if (!target || !source || this.#transform) return;
    this.#end = this.#gateway.followTransform(target, source, RATE_HZ, (transform) => {
      this.#transform = transform;
      this.#changed();
    });
  }
}
