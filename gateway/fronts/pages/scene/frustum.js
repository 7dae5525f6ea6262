// SPDX-License-Identifier: Apache-2.0
import { say } from "../shared/language.js";
import { BufferGeometry, LineBasicMaterial, LineSegments, Vector3 } from "../vendor/three.js";
import { Display } from "./display.js";

/** The view of a camera by its `sensor_msgs/msg/CameraInfo`, as deep as the layer's size says. */
export class FrustumDisplay extends Display {
  options = { compression: "cbor", throttle_rate: 1000 };
  #lines = new LineSegments(new BufferGeometry(), new LineBasicMaterial());
  #message = null;

  constructor(context, topic, look) {
    super(context, topic, look);
    this.#lines.frustumCulled = false;
    this.object.add(this.#lines);
  }

  restyle() {
    if (this.#message) this.show(this.#message);
  }

  show(message) {
    const { k, width, height } = message;
    if (!(k[0] > 0 && k[4] > 0)) throw new RangeError(say("frustum.uncalibrated"));
    this.#message = message;
    const depth = this.look.size;
    const corners = [[0, 0], [width, 0], [width, height], [0, height]].map(([x, y]) => new Vector3(((x - k[2]) / k[0]) * depth, ((y - k[5]) / k[4]) * depth, depth));
    const eye = new Vector3();
    const ends = corners.flatMap((corner, at) => [eye, corner, corner, corners[(at + 1) % 4]]);
    this.#lines.geometry.dispose();
    this.#lines.geometry = new BufferGeometry().setFromPoints(ends);
    this.#lines.material.color.set(this.look.colour);
  }
}
