// SPDX-License-Identifier: Apache-2.0
import { say } from "../shared/language.js";
import { Points, PointsMaterial } from "../vendor/three.js";
import { Display } from "./display.js";
import { Places } from "./points.js";

/** The ways to colour a cloud, next to its own fields. */
export const PLAIN_MODES = ["height", "flat"];

/** A `sensor_msgs/msg/PointCloud2`, thinned by the gateway. A worker gives its points their colours. */
export class CloudDisplay extends Display {
  /** The fields that the cloud can be coloured by. */
  available = [];
  #worker = new Worker(new URL("./cloud_worker.js", import.meta.url), { type: "module" });
  #isBusy = false;
  #failure = ""; // of the worker, until it has painted again
  #next = null;
  #places = new Places(Int16Array, true);
  #points = new Points(this.#places.geometry, new PointsMaterial({ vertexColors: true }));

  constructor(context, topic, look) {
    super(context, topic, look);
    this.#points.frustumCulled = false;
    this.object.add(this.#points);
    this.#worker.onmessage = ({ data }) => this.#painted(data);
    this.#worker.onerror = (event) => {
      event.preventDefault(); // it is told of here
      this.#failed(event.message || say("worker.none"));
    };
    this.restyle();
  }

  /** How many points are drawn. */
  get count() {
    return this.#places.count;
  }

  open() {
    const field = PLAIN_MODES.includes(this.look.mode) ? [] : [this.look.mode];
    this.options = { compression: "cbor", throttle_rate: 50, cloud: { max_points: this.look.points, ...(this.look.voxel && { voxel_m: this.look.voxel }), fields: field } };
    super.open();
  }

  restyle() {
    this.#points.material.size = this.look.size;
  }

  show(message) {
    if (message.format !== "int16") throw new RangeError(say("cloud.whole"));
    this.available = message.available.filter((name) => !["x", "y", "z"].includes(name));
    this.#next = message;
    this.#send();
    if (this.#failure) throw new Error(this.#failure);
  }

  close() {
    this.#worker.terminate();
    super.close();
  }

  /** Have the newest message painted, once the one before is. */
  #send() {
    if (this.#isBusy || !this.#next) return;
    const { data, points, fields } = this.#next;
    this.#next = null;
    this.#isBusy = true;
    const { buffer } = data.slice();
    this.#worker.postMessage({ buffer, points, fields, mode: this.look.mode, colour: this.look.colour }, [buffer]);
  }

  #failed(why) {
    this.#isBusy = false;
    this.#failure = why;
    this.problem = say("unshown", { why });
    this.#send();
  }

  #painted({ places, colours, scale, offset }) {
    this.#isBusy = false;
    this.#failure = this.problem = "";
    const count = places.length / 3;
    this.#places.hold(count);
    this.#places.places.set(places);
    this.#places.colours.set(colours);
    this.#places.draw(count);
    this.#points.scale.fromArray(scale);
    this.#points.position.fromArray(offset);
    this.context.changed();
    this.#send();
  }
}
