// SPDX-License-Identifier: Apache-2.0
import { element, span } from "../shared/dom.js";
import { say } from "../shared/language.js";

const MOST_FRAMES = 1000;
const LATE_MS = 2000;
const RATE_MS = 1000; // between two looks at how often a frame came

/** The tree of transforms: who is whose parent, how often each comes, and what is wrong with it. */
export class FramesView {
  static title = say("view.frames");
  static types = ["tf2_msgs/msg/TFMessage"];

  options = {};
  rest = 500;
  element = element("div", { className: "frames" });
  #frames = new Map(); // name of the child -> Frame
  #tree = element("ul", { className: "branches" });
  #problems = element("ul", { className: "wrong" });
  #isStatic;
  #end;
  #lookedMs = 0;
  #shape = ""; // of the tree that is drawn
  #roots = []; // names of frames without a parent
  #lost = []; // frames in a loop
  #hasLeftOut = false;

  constructor(card) {
    this.#isStatic = card.topic.endsWith("_static");
    const other = this.#isStatic ? card.topic.replace(/_static$/, "") : `${card.topic}_static`; // of the same robot
    this.#end = card.gateway.subscribe(other, { type: FramesView.types[0] }, (message) => this.#take(message, !this.#isStatic), () => {});
    this.element.append(this.#problems, this.#tree);
  }

  keep(message) {
    this.#take(message, this.#isStatic);
  }

  show() {
    this.#write();
  }

  draw() {
    if (performance.now() - this.#lookedMs > RATE_MS) this.#write();
  }

  close() {
    this.#end();
  }

  #take({ transforms }, isStatic) {
    for (const { header, child_frame_id: child } of transforms) {
      const known = this.#frames.get(child);
      if (known) known.take(header.frame_id, isStatic);
      else if (this.#hasRoom()) this.#frames.set(child, new Frame(child, header.frame_id, isStatic));
    }
  }

  /** Whether one more frame has room. One that comes no longer gives way to it. */
  #hasRoom() {
    if (this.#frames.size < MOST_FRAMES) return true;
    this.#hasLeftOut = true;
    const silent = [...this.#frames.values()].find(({ isLate }) => isLate);
    if (!silent) return false;
    this.#frames.delete(silent.name);
    silent.element.remove();
    return true;
  }

  #write() {
    const now = performance.now();
    const passedMs = now - this.#lookedMs;
    if (passedMs > RATE_MS) this.#lookedMs = now;
    const shape = [...this.#frames.values()].map(({ name, parent }) => `${parent}>${name}`).join("|");
    if (shape !== this.#shape) this.#plant();
    this.#shape = shape;
    for (const each of this.#frames.values()) each.write(passedMs);
    this.#tell();
  }

  /** Put each frame below its parent. */
  #plant() {
    const roots = new Map([...this.#frames.values()].filter(({ parent }) => !this.#frames.has(parent)).map(({ parent }) => [parent, element("ul")]));
    for (const each of this.#frames.values()) {
      each.children.remove();
      each.element.remove();
    }
    const reached = new Set();
    const grow = (parent, list) => {
      for (const each of this.#frames.values()) {
        if (each.parent !== parent || reached.has(each)) continue;
        reached.add(each);
        list.append(each.element);
        grow(each.name, each.children);
        if (each.children.childElementCount) each.element.append(each.children);
      }
    };
    for (const [root, list] of roots) grow(root, list);
    this.#tree.replaceChildren(...[...roots].map(([root, list]) => element("li", {}, element("bdi", { className: "frame" }, root || say("where.nameless")), list)));
    this.#lost = [...this.#frames.values()].filter((each) => !reached.has(each));
    this.#roots = [...roots.keys()];
  }

  #tell() {
    const words = this.#hasLeftOut ? [say("tf.many", { most: MOST_FRAMES })] : [];
    if (this.#roots.length > 1) words.push(say("tf.apart", { count: this.#roots.length, names: this.#roots.join(", ") }));
    if (this.#lost.length) words.push(say("tf.loop", { names: this.#lost.map(({ name }) => name).join(", ") }));
    for (const { name, parents } of this.#frames.values()) if (parents.size > 1) words.push(say("tf.parents", { name, names: [...parents].join(", ") }));
    if (words.join() === [...this.#problems.children].map((each) => each.textContent).join()) return;
    this.#problems.replaceChildren(...words.map((each) => element("li", {}, each)));
  }
}

/** A frame with its parent. */
class Frame {
  element = element("li");
  children = element("ul");
  #about = element("small", { className: "quiet" });
  #heardMs = performance.now();
  #count = 0; // since the rate was reckoned
  #hz = 0;

  constructor(name, parent, isStatic) {
    this.name = name;
    this.parent = parent;
    this.parents = new Set([parent]);
    this.isStatic = isStatic;
    this.element.append(element("bdi", { className: "frame" }, name), " ", this.#about);
  }

  take(parent, isStatic) {
    this.parent = parent;
    if (this.parents.size < 8) this.parents.add(parent);
    this.isStatic = isStatic;
    this.#heardMs = performance.now();
    this.#count += 1;
  }

  get ageMs() {
    return performance.now() - this.#heardMs;
  }

  get isLate() {
    return !this.isStatic && this.ageMs > LATE_MS;
  }

  write(passedMs) {
    if (passedMs > RATE_MS) {
      this.#hz = (this.#count * 1000) / passedMs;
      this.#count = 0;
    }
    const { ageMs, isLate } = this;
    const words = this.isStatic ? say("tf.static") : isLate ? say("tf.old", { age: span(ageMs) }) : `${this.#hz.toFixed(this.#hz < 10 ? 1 : 0)} Hz`;
    if (this.#about.textContent === words) return;
    this.#about.textContent = words;
    this.#about.classList.toggle("late", isLate);
  }
}
