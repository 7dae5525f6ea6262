// SPDX-License-Identifier: Apache-2.0
// The frames of ROS as groups in one scene, each where the newest transforms say.

import { say } from "../shared/language.js";
import { Group, Quaternion, Vector3 } from "../vendor/three.js";

const MISSING_MS = 2000; // so long a transform may take to come
const MOST_FRAMES = 2000; // a program may name a new one for each thing that it sees
const DEEPEST = 100; // frames above another one: more are a loop
const STATIC = "/tf_static";
const MAIN = ["map", "odom", "base_footprint", "base_link"]; // REP 105, the best to see everything in first

/** Return the name of a frame as tf2 has it. */
export const nameOf = (frame) => (frame ?? "").replace(/^\//, "");

/** The tree of transforms, and groups in it. A gateway follows a few transforms for a page, and a scene may need many: so it reads all. */
export class Frames {
  /** All groups. It is in metres of the fixed frame: x ahead, y left, z up. */
  root = new Group();
  fixed = "";
  /** Why there are no transforms, in words, or "". */
  problem = "";
  #ends;
  /** @type {Map<string, {parent: string, place: any, turn: any, isFixed: boolean}>} the one that has not come for the longest time first */
  #tree = new Map();
  #hasLeftOut = false;
  /** @type {Map<string, {group: any, users: number, sinceMs: number}>} */
  #places = new Map();
  #isStale = true; // something may have moved since the last step
  #place = new Vector3();
  #turn = new Quaternion();
  #back = new Quaternion();

  /** @param {import("../shared/gateway.js").Gateway} gateway */
  constructor(gateway) {
    const hear = (topic) => gateway.subscribe(topic, { compression: "cbor" }, (message) => this.take(message, topic === STATIC), ({ msg, level, code }) => {
      if (level === "error") this.problem = msg;
      if (code === "fresh") this.problem = "";
    });
    this.#ends = ["/tf", STATIC].map(hear);
  }

  /** Take a `tf2_msgs/msg/TFMessage`. A fixed transform comes once. */
  take({ transforms }, isFixed = false) {
    for (const { header, child_frame_id: child, transform: { translation, rotation } } of transforms) {
      const [name, parent] = [nameOf(child), nameOf(header.frame_id)];
      const known = this.#tree.get(name) ?? this.#add();
      if (!known) continue;
      this.#tree.delete(name);
      this.#tree.set(name, known); // the newest is the last
      known.parent = parent;
      known.isFixed = isFixed;
      known.place.copy(translation);
      known.turn.set(rotation.x, rotation.y, rotation.z, rotation.w);
    }
    this.#isStale = true;
  }

  /** Make room for a frame. Without room for it, return null. */
  #add() {
    if (this.#tree.size >= MOST_FRAMES) {
      this.#hasLeftOut = true;
      const [oldest] = [...this.#tree].find(([, { isFixed }]) => !isFixed) ?? [];
      if (oldest === undefined) return null;
      this.#tree.delete(oldest);
    }
    return { parent: "", place: new Vector3(), turn: new Quaternion(), isFixed: false };
  }

  /** The frames that are left out, in words, or "". */
  get leftOut() {
    return this.#hasLeftOut ? say("frames.many", { most: MOST_FRAMES }) : "";
  }

  /** The names of all frames. */
  get names() {
    return new Set([...this.#tree].flatMap(([name, { parent }]) => [parent, name]));
  }

  /** The frame that shows the most: a map, or else the root of the tree. */
  get main() {
    const { names } = this;
    const known = MAIN.find((each) => names.has(each)) ?? [...names].find((each) => MAIN.includes(each.split("/").at(-1)));
    return this.#rootOf(known ?? names.values().next().value ?? "");
  }

  /** Place everything in another frame. */
  fix(frame) {
    this.fixed = nameOf(frame);
    this.#isStale = true;
  }

  /** Return the group of a frame for one more user, which releases it. It is invisible while nobody knows where it is. */
  hold(frame) {
    const name = nameOf(frame);
    if (!this.#places.has(name)) {
      const group = new Group();
      group.visible = false;
      this.root.add(group);
      this.#places.set(name, { group, users: 0, sinceMs: performance.now() });
      this.#isStale = true;
    }
    const place = this.#places.get(name);
    place.users += 1;
    return place.group;
  }

  release(frame) {
    const name = nameOf(frame);
    const place = this.#places.get(name);
    place.users -= 1;
    if (place.users) return;
    place.group.removeFromParent();
    this.#places.delete(name);
  }

  /** Move the groups to where their frames are now. Return whether any has moved. */
  step() {
    if (!this.#isStale) return false;
    this.#isStale = false;
    let hasMoved = false;
    for (const [name, { group }] of this.#places) {
      const isKnown = this.find(name, this.#place, this.#turn);
      const isSame = isKnown === group.visible && (!isKnown || (group.position.equals(this.#place) && group.quaternion.equals(this.#turn)));
      if (isSame) continue;
      hasMoved = true;
      group.visible = isKnown;
      if (!isKnown) continue;
      group.position.copy(this.#place);
      group.quaternion.copy(this.#turn);
    }
    return hasMoved;
  }

  /** Put the pose of a frame in the fixed one into *place* and *turn*. Return whether it is known. */
  find(frame, place, turn) {
    const name = nameOf(frame);
    const root = this.#rootOf(name);
    if (!name || root !== this.#rootOf(this.fixed)) return false;
    this.#inRoot(this.fixed, place, turn);
    const here = place.clone();
    this.#back.copy(turn).invert();
    this.#inRoot(name, place, turn);
    place.sub(here).applyQuaternion(this.#back);
    turn.premultiply(this.#back);
    return true;
  }

  /** Which frames have no place, in words, or "". */
  get missing() {
    const now = performance.now();
    const names = [...this.#places].filter(([, { group, sinceMs }]) => !group.visible && now - sinceMs > MISSING_MS).map(([name]) => name || say("where.nameless"));
    if (!names.length) return "";
    const some = names.slice(0, 3).join(", ");
    return say("frames.lost", { names: names.length > 3 ? say("frames.more", { names: some, count: names.length - 3 }) : some, frame: this.fixed || say("frames.scene") });
  }

  close() {
    for (const end of this.#ends) end();
  }

  #rootOf(name) {
    let at = name;
    for (let depth = 0; this.#tree.has(at) && depth < DEEPEST; depth += 1) at = this.#tree.get(at).parent;
    return at;
  }

  #inRoot(name, place, turn) {
    place.set(0, 0, 0);
    turn.set(0, 0, 0, 1);
    let at = this.#tree.get(name);
    for (let depth = 0; at && depth < DEEPEST; depth += 1) {
      place.applyQuaternion(at.turn).add(at.place);
      turn.premultiply(at.turn);
      at = this.#tree.get(at.parent);
    }
  }
}
