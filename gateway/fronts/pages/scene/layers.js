// SPDX-License-Identifier: Apache-2.0
// The list of what a scene shows: a line for each topic, with a checkbox, a colour and a size.

import { breakable, element } from "../shared/dom.js";
import { say } from "../shared/language.js";
import { PLAIN_MODES } from "./cloud.js";
import { FRAMES, kindOf } from "./kinds.js";

const THINNING = { points: 5000, voxel: 0.01 }; // steps

/** A layer as the address of the page keeps it: whether it is on, its topic, and its look. @typedef {{isOn: boolean, topic: string, look: import("./display.js").Look}} Kept */

/** The layers of a scene. */
export class Layers {
  element = element("ul", { className: "layers", aria: { label: say("layers") } });
  #context;
  #changed;
  #layers = new Map(); // topic -> Layer
  #wanted; // topic -> Kept

  /**
   * @param {import("./display.js").Context} context
   * @param {Kept[]} wanted
   * @param {() => void} changed is called when a user has changed something
   */
  constructor(context, wanted, changed) {
    this.#context = context;
    this.#changed = changed;
    this.#wanted = new Map(wanted.map((each) => [each.topic, each]));
  }

  /** Follow what there is in ROS. A topic that has gone keeps its line while it is shown. */
  learn() {
    const { graph } = this.#context.gateway;
    for (const { name, types } of [...graph.topics.values(), { name: FRAMES, types: [""] }]) {
      const kind = kindOf(name, types[0] ?? "");
      if (!kind || this.#layers.get(name)?.kind === kind) continue;
      this.#layers.get(name)?.close();
      this.#layers.set(name, new Layer(this.#context, name, kind, this.#wanted.get(name), this.#changed));
      this.#sort();
    }
    for (const [name, layer] of this.#layers) {
      if (name === FRAMES || graph.topics.has(name) || layer.isOn) continue;
      layer.close();
      this.#layers.delete(name);
    }
  }

  /** The displays that are on. */
  get displays() {
    return [...this.#layers.values()].map(({ display }) => display).filter(Boolean);
  }

  /** The layers that differ from their first look. @type {Kept[]} */
  get kept() {
    const changed = [...this.#layers.values()].filter((each) => each.isChanged).map((each) => each.kept);
    const absent = [...this.#wanted.values()].filter(({ topic }) => !this.#layers.has(topic));
    return [...changed, ...absent];
  }

  tick() {
    for (const each of this.#layers.values()) each.tick();
  }

  close() {
    for (const each of this.#layers.values()) each.close();
    this.#layers.clear();
  }

  #sort() {
    const order = [...this.#layers.values()].sort((one, other) => one.title.localeCompare(other.title));
    this.element.append(...order.map((each) => each.element));
  }
}

/** One line of the list, and its display while it is on. */
class Layer {
  display = null;
  /** @type {import("./display.js").Look} */ look;
  #context;
  #changed;
  #box = element("input", { type: "checkbox" });
  #more = element("span", { className: "look" });
  #namespaces = element("ul", {});
  #problem = element("small", { className: "problem", hidden: true });
  #modes = element("select", { title: say("layers.colors") });
  #first;

  constructor(context, topic, kind, wanted, changed) {
    this.topic = topic;
    this.kind = kind;
    this.#context = context;
    this.#changed = changed;
    this.#first = { colour: kind.colour ?? "", size: kind.size?.value ?? 0, mode: kind.mode ?? "", points: kind.isThinned ? context.mostPoints : 0, voxel: 0 };
    this.look = { ...this.#first, ...wanted?.look };
    this.title = `${kind.name} ${topic}`;
    this.#box.checked = wanted ? wanted.isOn : !kind.isOff;
    this.#box.onchange = () => {
      this.#turn();
      changed();
    };
    this.#offer();
    const name = element("label", {}, this.#box, element("span", {}, `${kind.name} `, element("small", {}, breakable(topic))));
    this.element = element("li", {}, name, this.#more, this.#namespaces, this.#problem);
    this.#turn();
  }

  get isOn() {
    return this.#box.checked;
  }

  get kept() {
    return { isOn: this.isOn, topic: this.topic, look: this.look };
  }

  get isChanged() {
    const isOther = Object.keys(this.#first).some((key) => this.look[key] !== this.#first[key]);
    return isOther || this.isOn === Boolean(this.kind.isOff);
  }

  tick() {
    const problem = this.display?.problem ?? "";
    if (this.#problem.textContent !== problem) this.#problem.textContent = problem;
    this.#problem.hidden = !problem;
    this.#listNamespaces();
    this.#offerModes();
    this.display?.tick();
  }

  close() {
    this.display?.close();
    this.display = null;
    this.element.remove();
  }

  #turn() {
    if (this.isOn && !this.display) {
      this.display = new this.kind.Display(this.#context, this.topic, this.look);
      this.display.open();
      this.display.tick();
    } else if (!this.isOn) {
      this.display?.close();
      this.display = null;
    }
    this.#more.hidden = !this.isOn;
    this.tick();
  }

  #offer() {
    const { kind, topic, look } = this;
    if (kind.colour) {
      const colour = element("input", { type: "color", value: look.colour, title: say("layers.color"), aria: { label: say("layers.color.of", { topic }) } });
      colour.oninput = () => this.#restyle({ colour: colour.value });
      this.#more.append(colour);
    }
    if (kind.size) {
      const { name, most, step } = kind.size;
      const size = element("input", { type: "range", min: String(step), max: String(most), step: String(step), title: name, aria: { label: say("size.of", { size: name, topic }) } });
      size.value = String(look.size); // once its limits are known
      size.oninput = () => this.#restyle({ size: Number(size.value) });
      this.#more.append(size);
    }
    if (kind.mode === "height") this.#more.append(this.#modes);
    this.#modes.setAttribute("aria-label", say("colors.of", { topic }));
    this.#modes.onchange = () => {
      this.#restyle({ mode: this.#modes.value });
      this.display?.open(); // it needs another field
    };
    if (kind.isThinned) this.#offerThinning();
  }

  /** Offer how the gateway thins a cloud. It refuses what is out of its range, in words that the line shows. */
  #offerThinning() {
    const { topic, look } = this;
    const inputs = Object.entries(THINNING).map(([key, step]) => {
      const label = say(`layers.${key}.of`, { topic });
      const input = element("input", { type: "number", min: "0", step: String(step), value: String(look[key]), title: label, aria: { label } });
      input.onchange = () => {
        input.value ||= String(this.#first[key]); // nothing, or no number
        this.#restyle({ [key]: Number(input.value) });
        this.display?.open();
      };
      return element("label", {}, say(`layers.${key}`), input);
    });
    this.#more.append(...inputs);
  }

  #offerModes() {
    if (this.kind.mode !== "height") return;
    const modes = [...new Set([...PLAIN_MODES, ...(this.display?.available ?? []), this.look.mode])];
    if (String([...this.#modes.options].map(({ value }) => value)) === String(modes)) return;
    this.#modes.replaceChildren(...modes.map((each) => new Option(PLAIN_MODES.includes(each) ? say(`layers.${each}`) : each, each, false, each === this.look.mode)));
  }

  #restyle(changed) {
    Object.assign(this.look, changed);
    this.display?.restyle();
    this.#context.changed();
    this.#changed();
  }

  #listNamespaces() {
    const names = this.display?.namespaces ?? [];
    const shown = [...this.#namespaces.children].map((each) => /** @type {HTMLElement} */ (each).dataset.name);
    if (String(names) === String(shown)) return;
    this.#namespaces.replaceChildren(...names.map((name) => {
      const box = element("input", { type: "checkbox", checked: !this.display.isHidden(name) });
      box.onchange = () => this.display.hide(name, !box.checked);
      return element("li", { dataset: { name } }, element("label", {}, box, name || say("layers.nameless")));
    }));
  }
}
