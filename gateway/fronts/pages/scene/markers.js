// SPDX-License-Identifier: Apache-2.0
import { say } from "../shared/language.js";
import { Group } from "../vendor/three.js";
import { meshOf } from "./assets.js";
import { Display, dispose, put } from "./display.js";
import { nameOf } from "./frames.js";
import { keyOf, leftOut, make, MESH, set, tint } from "./marker_shapes.js";

const MOST_MARKERS = 10_000; // the oldest is dropped for a newer one
const AGAIN_MS = 3000; // so long what the gateway keeps may take to come again
const [ADD, DELETE, DELETE_ALL] = [0, 2, 3];

/**
 * A marker that is shown. While its shape stays the same its object is kept, because to make one costs far more than to move one.
 * @typedef {{object: any, shape: string, frame: string|null, namespace: string, untilMs: number, problem: string, colour: any}} Shown
 */

/** Markers of `visualization_msgs`: each in its frame, by namespace and id, until its lifetime is over. */
export class MarkersDisplay extends Display {
  options = { compression: "cbor", throttle_rate: 0 }; // each message counts
  /** @type {Map<string, Shown>} by namespace and id, the one that has not come for the longest time first */
  #markers = new Map();
  #hidden = new Set(); // namespaces
  #earlier = new Set(); // keys of markers from before a rest, or of the connection before
  #againMs = Infinity; // when those of the connection before end
  #dropped = 0; // because there were too many
  /** @type {Set<Shown>} */
  #faulty = new Set();

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
    let problem = "";
    for (const marker of message.markers ?? [message]) {
      try {
        this.#do(marker);
      } catch (error) {
        problem ||= say("unshown", { why: error.message }); // the others can
      }
    }
    if (this.#againMs === Infinity) this.#dropEarlier(); // other kept messages may follow on a new connection
    return problem || this.#words;
  }

  tick() {
    const now = performance.now();
    for (const [key, { untilMs }] of this.#markers) if (untilMs <= now) this.#remove(key);
    if (now >= this.#againMs) this.#dropEarlier();
  }

  /** Nobody knows which markers were deleted while nothing came: the next message says it, because what it leaves out goes. */
  wake() {
    this.#earlier = new Set(this.#markers.keys());
    this.#againMs = Infinity;
  }

  /** Markers may have been deleted without a connection: those that do not come again go. Until then they stay, so nothing flickers. */
  restart() {
    this.wake();
    this.#againMs = performance.now() + AGAIN_MS;
  }

  close() {
    for (const key of [...this.#markers.keys()]) this.#remove(key);
    super.close();
  }

  #dropEarlier() {
    for (const key of this.#earlier) this.#remove(key);
    this.#earlier.clear();
    this.#againMs = Infinity;
  }

  get #words() {
    if (this.#markers.size < MOST_MARKERS) this.#dropped = 0;
    const [first] = this.#faulty;
    return first?.problem || (this.#dropped ? say("marker.many", { count: this.#dropped, most: MOST_MARKERS }) : "");
  }

  #do(marker) {
    const key = `${marker.ns}\n${marker.id}`;
    if (marker.action === DELETE) this.#remove(key);
    else if (marker.action === DELETE_ALL) {
      for (const [each, { namespace }] of this.#markers) if (!marker.ns || namespace === marker.ns) this.#remove(each);
    } else if (marker.action === ADD) this.#add(key, marker);
    else throw new RangeError(say("marker.action", { action: marker.action }));
  }

  #add(key, marker) {
    this.#earlier.delete(key);
    const shape = marker.type === MESH ? `mesh ${marker.mesh_use_embedded_materials} ${marker.mesh_resource}` : keyOf(marker);
    if (this.#markers.get(key)?.shape !== shape) this.#remove(key);
    const shown = this.#markers.get(key) ?? this.#make(marker, shape);
    this.#markers.delete(key);
    this.#markers.set(key, shown); // the newest is the last
    this.#move(shown, marker);
    const { sec, nanosec } = marker.lifetime;
    const lifeMs = sec * 1000 + nanosec / 1e6;
    shown.untilMs = lifeMs ? performance.now() + lifeMs : Infinity;
  }

  /** @returns {Shown} */
  #make(marker, shape) {
    const object = new Group();
    const isMesh = marker.type === MESH;
    if (!isMesh) object.add(make(marker));
    object.visible = !this.#hidden.has(marker.ns);
    while (this.#markers.size >= MOST_MARKERS) {
      this.#dropped += 1;
      this.#remove(this.#markers.keys().next().value);
    }
    const shown = { object, shape, frame: null, namespace: marker.ns, untilMs: Infinity, problem: "", colour: null };
    if (isMesh) this.#load(shown, marker);
    return shown;
  }

  #move(shown, marker) {
    const { object } = shown;
    put(object, marker.pose);
    const frame = nameOf(marker.header.frame_id);
    if (frame !== shown.frame) {
      this.context.frames.hold(frame).add(object);
      if (shown.frame !== null) this.context.frames.release(shown.frame);
      shown.frame = frame;
    }
    if (marker.type === MESH) {
      object.scale.copy(marker.scale);
      shown.colour = marker.mesh_use_embedded_materials ? null : marker.color;
      paint(shown);
    } else {
      set(object.children[0], marker);
      this.#fault(shown, leftOut(marker));
    }
  }

  async #load(shown, { mesh_resource: uri, mesh_use_embedded_materials: keepsColours, color: { r, g, b, a } }) {
    try {
      const mesh = await meshOf(this.context.gateway, uri, keepsColours ? null : { r, g, b, a });
      if (shown.object.parent) shown.object.add(mesh);
      else dispose(mesh); // its marker has ended
      paint(shown);
      this.context.changed();
    } catch (error) {
      if (!shown.object.parent) return;
      this.#fault(shown, error.message);
      this.problem = this.#words;
    }
  }

  #fault(shown, problem) {
    shown.problem = problem;
    if (problem) this.#faulty.add(shown);
    else this.#faulty.delete(shown);
  }

  #remove(key) {
    const marker = this.#markers.get(key);
    if (!marker) return;
    this.#markers.delete(key);
    this.#faulty.delete(marker);
    dispose(marker.object);
    marker.object.removeFromParent();
    if (marker.frame !== null) this.context.frames.release(marker.frame);
    this.context.changed();
  }
}

/** Give a mesh the colour of its marker, if it has not those of its file. */
function paint({ object, colour }) {
  if (colour) object.traverse(({ material }) => material && tint(material, colour, colour.a));
}
