// SPDX-License-Identifier: Apache-2.0
// Poses that no drive explains: odometry that was reset, or that is out of its mind. The target is another place then.
// Pure: pose and time are arguments.

import { say } from "../shared/language.js";
import { MOST, STALE_S, wrapped } from "./approach.js";

const FASTER = 1.5; // than its commands a robot may be, downhill or by its odometry's faults
// Times are those of arrival: a pose that was late lets the next one follow at once. One that is later than this ends an approach anyway.
const LATE_S = STALE_S;

/** Compares each pose with the one before. */
export class Jumps {
  #before = { x: NaN, y: NaN, yaw: NaN };
  #time = NaN;

  /**
   * Take a pose. Return how the robot cannot have come there from the one before, or "".
   * @param {{x: number, y: number, yaw: number}} pose in metres and radians
   * @param {number} time when it came, in seconds
   */
  take({ x, y, yaw }, time) {
    if (!Number.isFinite(x + y + yaw)) return ""; // it says nothing
    const seconds = FASTER * (time - this.#time + LATE_S); // NaN at first, which nothing exceeds
    const moved = Math.hypot(x - this.#before.x, y - this.#before.y);
    const turned = Math.abs(wrapped(yaw - this.#before.yaw));
    this.#before = { x, y, yaw };
    this.#time = time;
    if (moved > MOST.linear * seconds) return say("jump.moved", { metres: moved.toFixed(2) });
    if (turned > MOST.angular * seconds) return say("jump.turned", { degrees: Math.round((turned * 180) / Math.PI) });
    return "";
  }
}
