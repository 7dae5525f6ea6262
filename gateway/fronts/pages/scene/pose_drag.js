// SPDX-License-Identifier: Apache-2.0

import { whenUnseen } from "../shared/keys.js";

const LEAST_DRAG_M = 0.05; // a shorter drag says no heading
const TURN = Math.PI / 12; // of an arrow key
const STEP_M = 0.1;
const KEYS = { ArrowLeft: TURN, ArrowRight: -TURN };

/** A pose that is being given: pressed at a place, dragged to a heading, or with keys. */
export class PoseDrag {
  /** The pose so far, in the frame of its beginning, or null. @type {(import("./navigation.js").Place & {frame: string})|null} */
  pose = null;
  #begin;
  #changed;
  #given;

  /**
   * @param {() => {yaw: number, frame: string}} begin returns the heading that a pose has without a drag, and the frame that is shown
   * @param {() => void} changed
   * @param {(pose: import("./navigation.js").Place & {frame: string}) => void} given is called at its end
   */
  constructor(begin, changed, given) {
    this.#begin = begin;
    this.#changed = changed;
    this.#given = given;
  }

  /** Drop what has been begun at STOP, without a connection, and when nobody looks at it: its end would send the robot. */
  watch(gateway, where, signal) {
    const drop = () => this.pose && this.drop();
    const forgets = ["stopping", "state"].map((each) => gateway.on(each, drop));
    signal.addEventListener("abort", () => forgets.forEach((forget) => forget()));
    where.addEventListener("contextmenu", (event) => this.pose && event.preventDefault(), { signal }); // of a finger that stays
    whenUnseen(drop, { where, signal });
  }

  down({ x, y }) {
    this.pose = { x, y, ...this.#begin() };
    this.#changed();
  }

  move({ x, y }) {
    if (this.pose?.frame !== this.#begin().frame) return; // a place of another frame says nothing of the heading
    const [ahead, left] = [x - this.pose.x, y - this.pose.y];
    if (Math.hypot(ahead, left) > LEAST_DRAG_M) this.pose.yaw = Math.atan2(left, ahead);
    this.#changed();
  }

  up() {
    const { pose } = this;
    this.drop();
    if (pose) this.#given(pose);
  }

  drop() {
    this.pose = null;
    this.#changed();
  }

  /**
   * Take a key. Return whether it was for this.
   * @param {KeyboardEvent} event
   * @param {() => ({x: number, y: number}|null)} middle of the view
   */
  key({ key, repeat }, middle) {
    if (key === "Enter") {
      if (repeat) return true; // a held one would send the robot at once
      const place = middle();
      if (this.pose) this.up();
      else if (place) this.down(place);
      return true;
    }
    if (!this.pose) return false;
    if (key === "Escape") this.drop();
    else if (key in KEYS) this.pose.yaw = Math.atan2(Math.sin(this.pose.yaw + KEYS[key]), Math.cos(this.pose.yaw + KEYS[key]));
    else if (key === "ArrowUp" || key === "ArrowDown") {
      const along = key === "ArrowUp" ? STEP_M : -STEP_M;
      this.pose.x += Math.cos(this.pose.yaw) * along;
      this.pose.y += Math.sin(this.pose.yaw) * along;
    } else return false;
    this.#changed();
    return true;
  }
}
