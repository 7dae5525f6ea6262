// SPDX-License-Identifier: Apache-2.0
import { element } from "../shared/dom.js";
import { say } from "../shared/language.js";
import { meaningOf } from "./meaning.js";
import { isNumber, NON_FINITE } from "./numbers.js";

const MOST_ITEMS = 12; // of a list, until more are asked for
const MORE_ITEMS = 100; // a time
const MOST_CHARACTERS = 120;
const LARGE_BYTES = 100_000; // of a message: more is fetched on demand, as only some items of an array are shown

/** All fields of a message with their values. A number can be plotted. Of a large message, arrays come on demand. */
export class TreeView {
  static title = say("view.tree");

  options = { throttle_rate: 200 };
  element = element("div", { className: "tree" });
  #card;
  #empty = element("p", { className: "quiet" });
  #leftOut = element("p", { className: "quiet", hidden: true });
  #isSorted = false;
  #isClosed = false;
  #fields;

  /** @param {{plot: (path: string) => void, sortedFields?: () => Promise<{small: string[], large: string[]}>, subscribe?: () => void}} card */
  constructor(card) {
    this.#card = card;
    this.#fields = new Group("", (path) => card.plot(path));
    this.element.append(this.#empty, this.#fields.element, this.#leftOut);
  }

  show(message, data) {
    this.#empty.textContent = isNested(message) ? "" : say("tree.none");
    this.#fields.show(message);
    if (!this.#isSorted && this.#card.sortedFields && (data?.length ?? data?.byteLength) > LARGE_BYTES) this.#leaveOut();
  }

  close() {
    this.#isClosed = true;
  }

  /** Fetch the arrays of further messages only on request. */
  async #leaveOut() {
    this.#isSorted = true;
    const { small, large } = await this.#card.sortedFields();
    if (!large.length || this.#isClosed) return; // its card has gone, or shows another view
    this.options = { ...this.options, fields: small };
    const buttons = large.map((path) => {
      const button = element("button", { type: "button", aria: { label: say("tree.fetch.of", { path }) } }, `${say("tree.fetch")} `, element("bdi", {}, path));
      button.onclick = () => {
        this.options = { ...this.options, fields: [...this.options.fields, path] };
        button.remove();
        this.#leftOut.hidden = !this.#leftOut.querySelector("button");
        this.#card.subscribe();
      };
      return button;
    });
    this.#leftOut.append(`${say("tree.left")} `, ...buttons);
    this.#leftOut.hidden = false;
    this.#card.subscribe();
  }
}

/** The fields of a message, or the items of a list. Each row stays while its field does: a button that is made again loses the focus. */
class Group {
  element = element("div");
  #list = element("dl");
  #path;
  #plot;
  #value;
  #rows = new Map(); // name -> the row
  #most = MOST_ITEMS;
  #more = element("button", { type: "button" });
  #moreRow = element("div", { className: "row", hidden: true }, this.#more);

  constructor(path, plot) {
    this.#path = path;
    this.#plot = plot;
    this.#more.onclick = () => this.#showMore();
    this.element.append(this.#list, this.#moreRow);
  }

  show(value) {
    this.#value = value;
    const items = Object.entries(isList(value) ? value.slice(0, this.#most) : value);
    this.#removeOthers(new Set(items.map(([name]) => name)));
    let next = this.#list.firstElementChild;
    for (const [name, item] of items) {
      const row = this.#rows.get(name) ?? this.#add(name);
      row.show(item);
      if (row.element === next) next = next.nextElementSibling;
      else this.#list.insertBefore(row.element, next);
    }
    this.#count(isList(value) ? value.length - items.length : 0);
  }

  #removeOthers(names) {
    for (const [name, row] of this.#rows) {
      if (names.has(name)) continue;
      row.element.remove();
      this.#rows.delete(name);
    }
  }

  #add(name) {
    const row = new Row(name, this.#path ? `${this.#path}.${name}` : name, this.#plot);
    this.#rows.set(name, row);
    return row;
  }

  /** Say how many items of the list are not shown. */
  #count(hidden) {
    this.#moreRow.hidden = hidden === 0;
    this.#more.textContent = say("tree.more", { count: hidden });
    this.#more.setAttribute("aria-label", say("tree.more.of", { count: hidden, path: this.#path }));
  }

  #showMore() {
    const first = String(this.#most);
    this.#most += MORE_ITEMS;
    this.show(this.#value);
    this.#rows.get(first)?.element.querySelector("button:not([hidden])")?.focus();
  }
}

/** A name with its value, or with its fields. */
class Row {
  #path;
  #plot;
  #group = null;
  #leaf = null;
  #content = element("dd");
  #meaning = element("dd", { className: "quiet" });

  constructor(name, path, plot) {
    this.#path = path;
    this.#plot = plot;
    this.element = element("div", { className: "row" }, element("dt", {}, element("bdi", {}, name), ": "), this.#content);
  }

  show(value) {
    this.#explain(isNested(value) ? meaningOf(value) : "");
    if (isNested(value)) {
      this.#leaf = null;
      this.#group ??= this.#fill(new Group(this.#path, this.#plot));
      this.#group.show(value);
    } else {
      this.#group = null;
      this.#leaf ??= this.#fill(new Leaf(this.#path, this.#plot));
      this.#leaf.show(value);
    }
  }

  #explain(words) {
    if (this.#meaning.textContent === words) return;
    this.#meaning.textContent = words;
    if (words) this.#content.before(this.#meaning);
    else this.#meaning.remove();
  }

  #fill(made) {
    this.#content.replaceChildren(made.element);
    return made;
  }
}

/** A value, with a button that plots it while it is a number. */
class Leaf {
  #text = element("bdi"); // a text from right to left turns nothing around it
  #button;
  #isText = false;

  constructor(path, plot) {
    this.#button = element("button", { type: "button", title: say("tree.plot.of", { path }), aria: { label: say("tree.plot.of", { path }) } }, say("tree.plot"));
    this.#button.onclick = () => plot(path);
    this.element = element("span", {}, this.#text, " ", this.#button);
  }

  show(value) {
    this.#isText ||= typeof value === "string" && !NON_FINITE.includes(value); // a field that said "hello" before does not mean a number by "NaN"
    const isPlotted = !this.#isText && isNumber(value);
    this.#button.hidden = !isPlotted;
    const text = isPlotted ? String(value) : shown(value);
    if (this.#text.textContent !== text) this.#text.textContent = text; // else what is selected would be so no longer
  }
}

/** @returns {value is any[]} or a typed array */
const isList = (value) => Array.isArray(value) || ArrayBuffer.isView(value);

function isNested(value) {
  if (isList(value)) return value.length > 0;
  return typeof value === "object" && value !== null && Object.keys(value).length > 0;
}

function shown(value) {
  if (value && typeof value === "object") return isList(value) ? "[]" : say("tree.none");
  const text = typeof value === "string" ? JSON.stringify(value) : String(value);
  return text.length > MOST_CHARACTERS ? `${text.slice(0, MOST_CHARACTERS)} ... ${say("characters", { count: text.length })}` : text;
}
