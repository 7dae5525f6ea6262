// SPDX-License-Identifier: Apache-2.0
import { ConeGeometry, DoubleSide, Mesh, MeshBasicMaterial } from "../vendor/three.js";
import { Display } from "./display.js";

/** The cone of a `sensor_msgs/msg/Range`, as long as what it measures. */
export class RangeDisplay extends Display {
  #cone = new Mesh(new ConeGeometry(1, 1, 24, 1, true).rotateZ(Math.PI / 2).translate(0.5, 0, 0), new MeshBasicMaterial({ transparent: true, opacity: 0.4, side: DoubleSide, depthWrite: false }));

  constructor(context, topic, look) {
    super(context, topic, look);
    this.object.add(this.#cone);
    this.restyle();
  }

  restyle() {
    this.#cone.material.color.set(this.look.colour);
  }

  show({ range, max_range: most, field_of_view: angle }) {
    const length = Number.isFinite(range) ? Math.min(range, most) : most; // infinite: nothing is near
    if (!(length > 0)) {
      this.#cone.visible = false;
      return;
    }
    this.#cone.visible = true;
    const radius = length * Math.tan(angle / 2);
    this.#cone.scale.set(length, radius, radius);
  }
}
