// SPDX-License-Identifier: Apache-2.0
import { Line, LineBasicMaterial } from "../vendor/three.js";
import { Display } from "./display.js";
import { Places } from "./points.js";

const LIFT_M = 0.02; // above a map

/** A line through places: a `nav_msgs/msg/Path`, or the edge of a `geometry_msgs/msg/PolygonStamped`. */
export class PathDisplay extends Display {
  options = { compression: "cbor", throttle_rate: 200 };
  #places = new Places();
  #line = new Line(this.#places.geometry, new LineBasicMaterial());

  constructor(context, topic, look) {
    super(context, topic, look);
    this.#line.frustumCulled = false;
    this.object.add(this.#line);
    this.restyle();
  }

  restyle() {
    this.#line.material.color.set(this.look.colour);
  }

  show({ poses, polygon }) {
    const corners = polygon ? [...polygon.points, ...polygon.points.slice(0, 1)] : poses.map(({ pose }) => pose.position);
    this.#places.hold(corners.length);
    corners.forEach(({ x, y, z }, at) => this.#places.places.set([x, y, z + LIFT_M], 3 * at));
    this.#places.draw(corners.length);
  }
}
