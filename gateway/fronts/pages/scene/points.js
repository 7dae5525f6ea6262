// SPDX-License-Identifier: Apache-2.0
// Points whose number changes, in buffers that only grow.

import { BufferAttribute, BufferGeometry, DynamicDrawUsage } from "../vendor/three.js";

const LEAST = 1024;

/** A geometry with a place for each point, and perhaps a colour. */
export class Places {
  geometry = new BufferGeometry();
  count = 0;
  #Typed;
  #hasColours;
  #capacity = 0;

  /**
   * @param {any} Typed the kind of numbers
   * @param {boolean} hasColours in three octets each
   */
  constructor(Typed = Float32Array, hasColours = false) {
    this.#Typed = Typed;
    this.#hasColours = hasColours;
    this.hold(LEAST);
  }

  /** The numbers: x, y, z of each point. */
  get places() {
    return this.geometry.attributes.position.array;
  }

  get colours() {
    return this.geometry.attributes.color.array;
  }

  /** Have room for so many points. Without room, the points before are lost. */
  hold(count) {
    if (count <= this.#capacity) return;
    this.#capacity = Math.max(LEAST, 2 ** Math.ceil(Math.log2(count)));
    this.geometry.dispose();
    const attribute = (array, isNormalized) => new BufferAttribute(array, 3, isNormalized).setUsage(DynamicDrawUsage);
    this.geometry.setAttribute("position", attribute(new this.#Typed(3 * this.#capacity), false));
    if (this.#hasColours) this.geometry.setAttribute("color", attribute(new Uint8Array(3 * this.#capacity), true));
  }

  /** Draw the first points. */
  draw(count) {
    this.count = count;
    this.geometry.setDrawRange(0, count);
    for (const attribute of Object.values(this.geometry.attributes)) {
      attribute.clearUpdateRanges();
      attribute.addUpdateRange(0, 3 * count);
      attribute.needsUpdate = true;
    }
  }
}
