// SPDX-License-Identifier: Apache-2.0
import { say } from "../shared/language.js";
import { AxesHelper } from "../vendor/three.js";
import { Display, dispose } from "./display.js";
import { label } from "./label.js";

const MOST_FRAMES = 200; // further ones are not drawn

/** The axes of all frames that `/tf` and `/tf_static` name: x red, y green, z blue. */
export class AxesDisplay extends Display {
  #axes = new Map(); // frame -> its axes

  open() {} // the scene knows the frames

  tick() {
    const { names } = this.context.frames;
    for (const frame of this.#axes.keys()) if (!names.has(frame)) this.#remove(frame);
    this.problem = names.size > MOST_FRAMES ? say("axes.many", { most: MOST_FRAMES, count: names.size }) : "";
    for (const frame of names) {
      if (this.#axes.has(frame) || this.#axes.size >= MOST_FRAMES) continue;
      const axes = new AxesHelper(this.look.size);
      axes.add(label(frame, this.look.size / 3));
      this.context.frames.hold(frame).add(axes);
      this.#axes.set(frame, axes);
      this.context.changed();
    }
  }

  restyle() {
    this.#clear();
    this.tick();
  }

  close() {
    this.#clear();
    super.close();
  }

  #clear() {
    for (const frame of this.#axes.keys()) this.#remove(frame);
  }

  #remove(frame) {
    const axes = this.#axes.get(frame);
    this.#axes.delete(frame);
    dispose(axes);
    axes.removeFromParent();
    this.context.frames.release(frame);
    this.context.changed();
  }
}
