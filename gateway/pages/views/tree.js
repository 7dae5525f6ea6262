// SPDX-License-Identifier: Apache-2.0
import { element } from "../shared/dom.js";

const MOST_ITEMS = 12; // of a list, until more are asked for
const MORE_ITEMS = 100; // a time
const MOST_CHARACTERS = 120;

/** All fields of a message with their values; a number can be plotted. */
export class TreeView {
  options = { throttle_rate: 200 };
  element = element("div", { className: "tree" });
  #shape = "";
  #values = new Map(); // path -> the element that has its value
  #lengths = new Map(); // path of a list -> of how many items it shows
  #message;

  constructor(card) {
    this.card = card;
  }

  show(message) {
    this.#message = message;
    const leaves = [];
    const hidden = [];
    this.#collect(message, "", leaves, hidden);
    const shape = [...leaves.map(([path, value]) => `${path}:${typeof value}`), ...hidden].join("\n");
    if (shape !== this.#shape) {
      // Only then: a button that is made anew loses the focus.
      this.#shape = shape;
      this.#values.clear();
      this.element.replaceChildren(this.#list(message, ""));
    }
    for (const [path, value] of leaves) this.#values.get(path).textContent = shown(value);
  }

  #list(value, path) {
    const list = element("dl");
    for (const [name, item] of this.#entries(value, path)) {
      const its = below(path, name);
      list.append(element("div", { className: "row" }, element("dt", {}, `${name}: `), this.#item(item, its)));
    }
    const hidden = isList(value) ? value.length - this.#length(path) : 0;
    if (hidden > 0) list.append(this.#more(path, hidden));
    return list;
  }

  #more(path, hidden) {
    const button = element("button", { type: "button", aria: { label: `more of ${path}` } }, `${hidden} more`);
    button.onclick = () => {
      const length = this.#length(path);
      this.#lengths.set(path, length + MORE_ITEMS);
      this.#shape = "";
      this.show(this.#message);
      const first = below(path, length);
      for (const [its, text] of this.#values) if (its === first || its.startsWith(`${first}.`)) return text.parentElement.querySelector("button")?.focus();
    };
    return element("div", { className: "row" }, button);
  }

  #length(path) {
    return this.#lengths.get(path) ?? MOST_ITEMS;
  }

  #entries(value, path) {
    return Object.entries(isList(value) ? value.slice(0, this.#length(path)) : value);
  }

  #collect(value, path, leaves, hidden) {
    if (isList(value) && value.length > this.#length(path)) hidden.push(`${path}+${value.length}`);
    for (const [name, item] of this.#entries(value, path)) {
      const its = below(path, name);
      if (isNested(item)) this.#collect(item, its, leaves, hidden);
      else leaves.push([its, item]);
    }
  }

  #item(value, path) {
    if (isNested(value)) return element("dd", {}, this.#list(value, path));
    const text = element("span");
    this.#values.set(path, text);
    const item = element("dd", {}, text);
    if (typeof value === "number") {
      const button = element("button", { type: "button", title: `plot ${path}`, aria: { label: `plot ${path}` } }, "plot");
      button.onclick = () => this.card.plot(path);
      item.append(" ", button);
    }
    return item;
  }
}

/** @returns {value is any[]} or a typed array */
const isList = (value) => Array.isArray(value) || ArrayBuffer.isView(value);

function isNested(value) {
  if (isList(value)) return value.length > 0;
  return typeof value === "object" && value !== null && Object.keys(value).length > 0;
}

const below = (path, name) => (path ? `${path}.${name}` : String(name));

function shown(value) {
  const text = typeof value === "string" ? JSON.stringify(value) : String(value && typeof value === "object" ? "[]" : value);
  return text.length > MOST_CHARACTERS ? `${text.slice(0, MOST_CHARACTERS)} ... ${text.length} characters` : text;
}
