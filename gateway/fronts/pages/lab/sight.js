// SPDX-License-Identifier: Apache-2.0
// Finds the first thing that a ray meets: the floor, or something solid before it. You cannot point at a hidden floor.

import { Vector3 } from "../vendor/three.js";
import { meet } from "./floor.js";

const ground = new Vector3();

/** Looks along rays. */
export class Sight {
  #solids;
  #isHidden;
  #hits = []; // one for all rays: no garbage

  /**
   * @param {() => import("../vendor/three.js").Object3D[]} solids the visible things that hide the floor
   * @param {(ray: import("../vendor/three.js").Ray, place: Vector3) => boolean} [isHidden] whether something else hides it
   */
  constructor(solids, isHidden = () => false) {
    this.#solids = solids;
    this.#isHidden = isHidden;
  }

  /**
   * Return the thing that a ray meets before the floor, or null.
   * @param {import("../vendor/three.js").Raycaster} raycaster
   */
  thing(raycaster) {
    raycaster.far = meet(raycaster.ray, ground) ? raycaster.ray.origin.distanceTo(ground) : Infinity;
    this.#hits.length = 0;
    raycaster.intersectObjects(this.#solids(), false, this.#hits);
    return this.#hits[0]?.object ?? null;
  }

  /** Put into *place* where a ray meets the floor. Return whether it does, and nothing is before it. */
  floor(raycaster, place) {
    return meet(raycaster.ray, place) && !this.thing(raycaster) && !this.#isHidden(raycaster.ray, place);
  }
}
