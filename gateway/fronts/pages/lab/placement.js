// SPDX-License-Identifier: Apache-2.0
// The place of one frame in another, or in words why it is unknown.

import { say } from "../shared/language.js";

const HERE = { translation: { x: 0, y: 0, z: 0 }, rotation: { x: 0, y: 0, z: 0, w: 1 } };
const PATIENCE_MS = 2000; // by then a tree of transforms is complete, even on a slow network

/** Follows the transform between two frames, whatever they come to be. */
export class Placement {
  #gateway;
  #what;
  #rate;
  #take;
  #target = ""; // before there is one, and of who names none
  #source = null; // before there is anything to place
  #end = () => {};
  #unknownMs = Infinity; // since when. Infinity while it is known

  /**
   * @param {import("../shared/gateway.js").Gateway} gateway
   * @param {string} what is not shown without its place, in words
   * @param {number} rate of transforms, at most so many a second
   * @param {(transform: object|null) => void} take gets `translation` and `rotation`, or null while nobody knows
   */
  constructor(gateway, what, rate, take) {
    this.#gateway = gateway;
    this.#what = what;
    this.#rate = rate;
    this.#take = take;
  }

  /** Take the frame in which it is to be placed. */
  within(target) {
    if (target !== this.#target) this.#follow(target, this.#source);
  }

  /** Take the frame of what is to be placed. */
  of(source) {
    if (source !== this.#source) this.#follow(this.#target, source);
  }

  /** Why it is not shown, or "". */
  get words() {
    if (this.#source === null || performance.now() - this.#unknownMs < PATIENCE_MS) return "";
    if (!this.#target) return say("placed.target", { what: this.#what });
    if (!this.#source) return say("placed.source", { what: this.#what });
    return say("placed.transform", { what: this.#what, target: this.#target, source: this.#source });
  }

  #follow(target, source) {
    [this.#target, this.#source] = [target, source];
    this.#end();
    this.#end = () => {};
    this.#put(target && target === source ? HERE : null);
    if (target && source && target !== source) this.#end = this.#gateway.followTransform(target, source, this.#rate, (transform) => this.#put(transform));
  }

  #put(transform) {
    this.#unknownMs = transform ? Infinity : performance.now();
    this.#take(transform);
  }
}
