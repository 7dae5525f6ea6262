// SPDX-License-Identifier: Apache-2.0
import { element } from "../shared/dom.js";
import { say } from "../shared/language.js";

/** A topic in the 3D scene, with all else that the scene shows. The code of the scene comes with the first one. */
export class WorldView {
  static title = say("view.world");
  static types = ["sensor_msgs/msg/PointCloud2", "visualization_msgs/msg/Marker", "visualization_msgs/msg/MarkerArray", "geometry_msgs/msg/PolygonStamped"];
  options = { compression: "cbor", fields: [], throttle_rate: 1000 }; // the scene subscribes to what it shows
  element = element("div", {}, say("scene.loading"));
  #scene = null;
  #isClosed = false;
  #toldMs = 0;

  constructor(card) {
    this.#load(card);
  }

  show() {}

  draw() {
    this.#scene?.draw();
    const now = performance.now();
    if (now - this.#toldMs < 1000) return;
    this.#toldMs = now;
    this.#scene?.tick();
  }

  wake() {
    this.#scene?.wake();
  }

  close() {
    this.#isClosed = true;
    this.#scene?.close();
  }

  async #load(card) {
    try {
      const { SceneView } = await import("../scene/scene.js");
      if (this.#isClosed) return;
      const keep = () => {
        card.fields = this.#scene.kept;
        card.actions.changed();
      };
      this.#scene = new SceneView(card.gateway, card.fields, keep, card);
      this.element.replaceChildren(this.#scene.element);
    } catch (error) {
      this.element.textContent = say("scene.failed", { why: error.message });
    }
  }
}
