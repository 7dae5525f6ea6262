// SPDX-License-Identifier: Apache-2.0
// A viewer may stand within the walls, on the map, and around the robot. Beyond is nothing to find the way back by.

import { Vector3 } from "../vendor/three.js";
import { HALF_M } from "./room.js";

const AROUND_M = 3; // of the robot, wherever it is

/** A part of the floor. */
export class Bounds {
  #least = new Vector3(-HALF_M, -Infinity, -HALF_M);
  #most = new Vector3(HALF_M, Infinity, HALF_M);

  /**
   * Take the present sizes. This allocates nothing.
   * @param {number} reach how far the map reaches from the middle, in metres
   * @param {{x: number, y: number}} robot its place, in its own metres
   */
  set(reach, robot) {
    const half = Math.max(HALF_M, reach);
    const isSomewhere = Number.isFinite(robot.x + robot.y);
    const [x, z] = isSomewhere ? [-robot.y, -robot.x] : [0, 0];
    this.#least.set(Math.min(-half, x - AROUND_M), -Infinity, Math.min(-half, z - AROUND_M));
    this.#most.set(Math.max(half, x + AROUND_M), Infinity, Math.max(half, z + AROUND_M));
  }

  /** Move a place to the nearest one within. */
  keep(place) {
    place.clamp(this.#least, this.#most);
  }

  /** Do so with a step from another place. A viewer who is outside, because the robot went home, is not moved, but goes no farther out. */
  keepStep(place, from) {
    place.x = Math.max(Math.min(this.#least.x, from.x), Math.min(Math.max(this.#most.x, from.x), place.x));
    place.z = Math.max(Math.min(this.#least.z, from.z), Math.min(Math.max(this.#most.z, from.z), place.z));
  }
}
