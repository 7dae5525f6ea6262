// SPDX-License-Identifier: Apache-2.0
import { Points, PointsMaterial } from "../vendor/three.js";
import { isHit } from "../views/plan.js";
import { Display } from "./display.js";
import { Places } from "./points.js";

/** The hits of a `sensor_msgs/msg/LaserScan`. */
export class ScanDisplay extends Display {
  #places = new Places();
  #points = new Points(this.#places.geometry, new PointsMaterial());

  constructor(context, topic, look) {
    super(context, topic, look);
    this.#points.frustumCulled = false;
    this.object.add(this.#points);
    this.restyle();
  }

  restyle() {
    this.#points.material.color.set(this.look.colour);
    this.#points.material.size = this.look.size;
  }

  show({ ranges, angle_min: first, angle_increment: step, range_min: least, range_max: most }) {
    this.#places.hold(ranges.length);
    const { places } = this.#places;
    let count = 0;
    for (let at = 0; at < ranges.length; at += 1) {
      const range = ranges[at];
      if (!isHit(range, least, most)) continue;
      places[3 * count] = Math.cos(first + at * step) * range;
      places[3 * count + 1] = Math.sin(first + at * step) * range;
      count += 1;
    }
    this.#places.draw(count);
  }
}
