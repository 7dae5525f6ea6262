// SPDX-License-Identifier: Apache-2.0
import { breakable, element } from "../shared/dom.js";
import { count, say } from "../shared/language.js";
import { rove } from "./roving.js";

/**
 * An entry of a list: a name, the words about it, and whether it is shown without a search.
 * @typedef {{name: string, about: string, isPlain: boolean}} Entry
 */

/** Names of the ROS graph, as a list that can be searched. */
export class NameList {
  #list;
  #search;
  #kind;
  #entries;
  #open;
  #counted;
  #allows;
  #items = new Map(); // name -> its item, and the button in it. One that stays keeps the focus
  #opened = new Set(); // names that have a card
  #settle;

  /**
   * @param {HTMLElement} list
   * @param {HTMLInputElement} search
   * @param {import("../shared/gateway.js").Gateway} gateway
   * @param {{kind: string, entries: (graph: import("../shared/graph.js").Graph) => Entry[], open: (name: string) => void, allows: (name: string) => boolean, counted: (words: string) => void}} about
   */
  constructor(list, search, gateway, { kind, entries, open, allows, counted }) {
    this.#list = list;
    this.#search = search;
    this.#kind = kind;
    this.#entries = () => entries(gateway.graph);
    this.#open = open;
    this.#counted = counted;
    this.#allows = allows;
    this.#settle = rove(list);
    search.addEventListener("input", () => this.#write());
    gateway.on("graph", () => this.#write());
  }

  /** Mark the names that have a card. */
  mark(names) {
    this.#opened = names;
    mark(this.#items, names);
  }

  #write() {
    const entries = this.#entries();
    const wanted = this.#search.value.trim().toLowerCase();
    const found = entries
      .filter(({ name, about, isPlain }) => this.#allows(name) && (wanted ? `${name} ${about}`.toLowerCase().includes(wanted) : isPlain))
      .sort((one, other) => one.name.localeCompare(other.name));
    const names = new Set(entries.map(({ name }) => name));
    for (const name of this.#items.keys()) if (!names.has(name)) this.#items.delete(name);
    replace(this.#list, found.map((each) => this.#item(each).element), wanted ? say(`list.none.${this.#kind}`, { wanted }) : say(`list.no.${this.#kind}`));
    this.#settle();
    const words = countOf(found.length, entries.length, this.#kind);
    this.#counted(!wanted && found.length < entries.length ? say("list.more", { words }) : words);
  }

  #item({ name, about }) {
    if (!this.#items.has(name)) {
      const pressed = String(this.#opened.has(name));
      const button = element("button", { type: "button", className: "ghost", title: `${name}\n${about}`.trim(), aria: { pressed } }, element("span", { className: "name" }, breakable(name)), element("small", { className: "name" }, breakable(about)));
      button.onclick = () => this.#open(name);
      this.#items.set(name, { button, element: element("li", {}, button) });
    }
    return this.#items.get(name);
  }
}

/** Show on the buttons of a list which names have a card. */
export function mark(items, names) {
  for (const [name, { button }] of items) button.setAttribute("aria-pressed", names.has(name));
}

/** Return how many of how many are listed, in words. */
export function countOf(shown, all, kind) {
  const words = count(`list.${kind}`, all);
  return shown === all ? words : say("list.of", { shown, words });
}

/**
 * Put items into a list, or the reason why it is empty. An item that stays is not taken out for a moment. It would lose the focus, and a press
 * that has begun on it.
 */
export function replace(list, items, reason) {
  const shown = items.length ? items : [element("li", { className: "empty" }, reason)];
  const stays = new Set(shown);
  for (const each of [...list.children]) if (!stays.has(each)) each.remove();
  shown.forEach((each, index) => {
    if (list.children[index] !== each) list.insertBefore(each, list.children[index] ?? null);
  });
}
