// SPDX-License-Identifier: Apache-2.0
import { Group } from "../vendor/three.js";
import { meshOf } from "./assets.js";
import { Display, dispose, put } from "./display.js";
import { nameOf } from "./frames.js";
import { shapeOf, MESH } from "./marker_shapes.js";

const MOST_MARKERS = 10_000; // the oldest is dropped for a newer one
const [ADD, DELETE, DELETE_ALL] = [0, 2, 3];

/** Markers of `visualization_msgs`: each in its frame, by namespace and id, until its lifetime is over. */
export class MarkersDisplay extends Display {
  options = { compression: "cbor", throttle_rate: 0 }; // each message counts
  #markers = new Map(); // namespace and id -> {object, frame, namespace, untilMs}
  #hidden = new Set(); // namespaces

  /** The namespaces of the markers that there are. */
  get namespaces() {
    return [...new Set([...this.#markers.values()].map(({ namespace }) => namespace))].sort();
  }

  get count() {
    return this.#markers.size;
  }

  isHidden(namespace) {
    return this.#hidden.has(namespace);
  }

  hide(namespace, isHidden) {
    if (isHidden) this.#hidden.add(namespace);
    else this.#hidden.delete(namespace);
    for (const each of this.#markers.values()) if (each.namespace === namespace) each.object.visible = !isHidden;
    this.context.changed();
  }

  within() {} // each marker has its frame

  show(message) {
    for (const marker of message.markers ?? [message]) this.#do(marker);
  }

  tick() {
    const now = performance.now();
    for (const [key, { untilMs }] of this.#markers) if (untilMs <= now) this.#remove(key);
  }

  close() {
    for (const key of [...this.#markers.keys()]) this.#remove(key);
    super.close();
  }

  #do(marker) {
    const key = `${marker.ns}\n${marker.id}`;
    if (marker.action === DELETE) this.#remove(key);
    else if (marker.action === DELETE_ALL) {
      for (const [each, { namespace }] of this.#markers) if (!marker.ns || namespace === marker.ns) this.#remove(each);
    } else if (marker.action === ADD) this.#add(key, marker);
    else throw new RangeError(`its action is ${marker.action}`);
  }

  #add(key, marker) {
    this.#remove(key);
    while (this.#markers.size >= MOST_MARKERS) this.#remove(this.#markers.keys().next().value);
    const object = new Group();
    put(object, marker.pose);
    if (marker.type === MESH) this.#mesh(object, marker);
    else object.add(shapeOf(marker));
    object.visible = !this.#hidden.has(marker.ns);
    const frame = nameOf(marker.header.frame_id);
    this.context.frames.hold(frame).add(object);
    const { sec, nanosec } = marker.lifetime;
    const lifeMs = sec * 1000 + nanosec / 1e6;
    this.#markers.set(key, { object, frame, namespace: marker.ns, untilMs: lifeMs ? performance.now() + lifeMs : Infinity });
  }

  async #mesh(object, { mesh_resource: uri, mesh_use_embedded_materials: keepsColours, color: { r, g, b, a }, scale }) {
    object.scale.set(scale.x, scale.y, scale.z);
    try {
      const mesh = await meshOf(this.context.gateway, uri, keepsColours ? null : { r, g, b, a });
      if (object.parent) object.add(mesh);
      else dispose(mesh); // its marker has ended
      this.context.changed();
    } catch (error) {
      this.problem = error.message;
    }
  }

  #remove(key) {
    const marker = this.#markers.get(key);
    if (!marker) return;
    this.#markers.delete(key);
    dispose(marker.object);
    marker.object.removeFromParent();
    this.context.frames.release(marker.frame);
    this.context.changed();
  }
}
