// SPDX-License-Identifier: Apache-2.0
// The points of a depth camera or a lidar in the room, where the transforms say.

import { say } from "../shared/language.js";
import { Group } from "../vendor/three.js";
import { CloudDisplay } from "../scene/cloud.js";
import { asRos } from "./floor.js";
import { Placement } from "./placement.js";

const PLACE_HZ = 10;
const LOOK = { colour: "#ffffff", size: 0.025, mode: "height" };

/** One `sensor_msgs/msg/PointCloud2`, thinned by the gateway. */
export class Cloud {
  world = asRos(new Group());
  #holder = new Group();
  #placement;
  #display = null;

  /** @param {import("../shared/gateway.js").Gateway} gateway */
  constructor(gateway) {
    this.world.add(this.#holder);
    this.#placement = new Placement(gateway, say("hidden.cloud"), PLACE_HZ, (transform) => this.#place(transform));
    const hold = (frame) => {
      this.#placement.of(frame);
      return this.#holder;
    };
    /** @type {any} of a scene with one frame */
    this.context = { gateway, frames: { hold, release() {} }, changed() {} };
  }

  /** Show a topic. */
  open(topic) {
    this.#display = new CloudDisplay(this.context, topic, LOOK);
    this.#display.open();
  }

  /** Take the frame of the odometry. */
  within(frame) {
    this.#placement.within(frame);
  }

  /** How many points are drawn. */
  get points() {
    return this.#holder.visible ? this.#display?.count ?? 0 : 0;
  }

  /** Why it is not shown, in words, or "". */
  get words() {
    return this.#display?.problem || this.#placement.words;
  }

  #place(transform) {
    this.#holder.visible = transform !== null;
    if (!transform) return;
    this.#holder.position.copy(transform.translation);
    this.#holder.quaternion.copy(transform.rotation);
  }
}
