// SPDX-License-Identifier: Apache-2.0
// The base of all that a scene shows of one topic.

import { say } from "../shared/language.js";
import { Group } from "../vendor/three.js";

/**
 * The look of a layer: its colour, a number whose meaning its kind says, and what else the kind offers. Of a cloud, also how many points it has
 * at most, and the width in metres of the cubes that keep one point, or 0.
 * @typedef {{colour: string, size: number, mode: string, points: number, voxel: number}} Look
 */

/**
 * The surroundings of a display.
 * @typedef {object} Context
 * @property {import("../shared/gateway.js").Gateway} gateway
 * @property {import("./frames.js").Frames} frames
 * @property {() => void} changed asks for a new picture
 * @property {number} mostPoints of a cloud at first
 */

/** One topic in a scene: its messages, in the frame that they name. */
export class Display {
  /** Members of `subscribe`. @type {object} */
  options = { compression: "cbor", throttle_rate: 50 };
  /** The problem in words, or "". */
  problem = "";
  object = new Group();
  #unsubscribe = () => {};
  #frame = null;

  /**
   * @param {Context} context
   * @param {string} topic
   * @param {Look} look
   */
  constructor(context, topic, look) {
    this.context = context;
    this.topic = topic;
    this.look = look;
  }

  open() {
    const endBefore = this.#unsubscribe;
    this.#unsubscribe = this.context.gateway.subscribe(this.topic, this.options, (message) => this.take(message), ({ msg, level }) => {
      if (level !== "info") this.problem = msg;
    });
    endBefore();
  }

  /** Take a message. Its problem says why it cannot be shown. */
  take(message) {
    try {
      if (message.header) this.within(message.header.frame_id);
      this.problem = /** @type {string} */ (this.show(message) ?? "");
    } catch (error) {
      this.problem = say("unshown", { why: error.message });
    }
    this.context.changed();
  }

  /**
   * Show a message. Return what is left out of it, in words, if anything is.
   * @abstract
   * @param {any} _message
   * @returns {string|void}
   */
  show(_message) {}

  /** Take another look. */
  restyle() {}

  /** Do what time asks for, a few times a second. */
  tick() {}

  /** Go on after nothing has come for a while. */
  wake() {}

  /** Begin from scratch, as the gateway does with a new connection: it sends again what it has. */
  restart() {}

  /** Put it in a frame. */
  within(frame) {
    if (frame === this.#frame) return;
    const group = this.context.frames.hold(frame);
    if (this.#frame !== null) this.context.frames.release(this.#frame);
    this.#frame = frame;
    group.add(this.object);
  }

  close() {
    this.#unsubscribe();
    dispose(this.object);
    this.object.removeFromParent();
    if (this.#frame !== null) this.context.frames.release(this.#frame);
    this.context.changed();
  }
}

/** Free what an object and all below it hold of the GPU. */
export function dispose(object) {
  object.traverse((each) => {
    each.geometry?.dispose();
    for (const material of [each.material ?? []].flat()) {
      material.map?.image?.close?.();
      material.map?.dispose();
      material.dispose();
    }
    if (each.isInstancedMesh) each.dispose();
  });
}

/** Put an object where a pose of ROS is. */
export function put(object, { position, orientation: { x, y, z, w } }) {
  object.position.set(position.x, position.y, position.z);
  if (x === 0 && y === 0 && z === 0 && w === 0) object.quaternion.set(0, 0, 0, 1); // left out
  else object.quaternion.set(x, y, z, w).normalize();
}
