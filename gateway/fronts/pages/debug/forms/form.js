// SPDX-License-Identifier: Apache-2.0
import { element } from "../../shared/dom.js";
import { json, parse } from "../../shared/json.js";
import { say } from "../../shared/language.js";
import { counted, expected, fieldOf, jsonOf, size } from "./fields.js";
import { checkFit, MOST_ITEMS, written } from "./filling.js";
import { valueOf } from "./typed.js";

const SMALL = 12; // values: so many are shown at once

/** A form for a message, of which what is left empty has its default. Or the same as JSON. */
export class Form {
  element = element("div", { className: "form" });
  #field;
  #group;
  #text = null; // the field for JSON, while it is shown

  /** @param {object} schema of a message, as `describe` gives it */
  constructor(schema) {
    this.#field = fieldOf(schema);
    this.#group = new Group(this.#field);
    this.element.append(this.#group.content);
    this.#group.build();
  }

  /** Whether the message is written as JSON. */
  get isText() {
    return this.#text !== null;
  }

  /**
   * Return the message as JSON.
   * @throws {Error} in words. The wrong field has the focus
   */
  json() {
    if (!this.#text) return this.#group.json() ?? "{}";
    try {
      valueOf(this.#text.value);
    } catch (error) {
      this.#text.focus();
      throw error;
    }
    return this.#text.value; // not what was parsed: a browser may round large integers
  }

  /**
   * Write the message as JSON, or in fields again.
   * @throws {Error} in words, if the fields cannot hold all of it
   */
  toggle() {
    const message = parse(this.json());
    if (this.#text) {
      checkFit(this.#field, message);
      this.#group.fill(message);
      this.#text = null;
      this.element.replaceChildren(this.#group.content);
      return;
    }
    this.#text = element("textarea", { value: json(message, 2), rows: 10, spellcheck: false, aria: { label: say("form.json.message") } });
    this.element.replaceChildren(this.#text);
  }
}

/** The fields of a message within another. They are made when they are opened, because some have hundreds. */
class Group {
  content = element("div", { className: "group" });
  /** @type {HTMLElement|null} where it stands in a list */
  row = null;
  #field;
  #path;
  #controls = null;

  /** @param {string} [path] the names of the groups that hold it */
  constructor(field, path = "") {
    this.#field = field;
    const { name, about } = field;
    this.#path = `${path} ${name}`.trim();
    this.element = element("details", {}, element("summary", { title: about }, name), this.content);
    this.element.ontoggle = () => this.build();
    this.element.open = size(field) <= SMALL;
    if (this.element.open) this.build();
  }

  build() {
    if (this.#controls) return;
    this.#controls = this.#field.fields.map((each) => controlOf(each, this.#path));
    this.content.append(...this.#controls.map((each) => each.element));
    if (!this.#controls.length) this.content.append(element("p", { className: "quiet" }, say("field.none")));
  }

  json() {
    const members = (this.#controls ?? []).map((each) => [each.name, each.json()]).filter(([, text]) => text !== undefined);
    if (!members.length) return undefined;
    return `{${members.map(([name, text]) => `${JSON.stringify(name)}:${text}`).join(",")}}`;
  }

  get name() {
    return this.#field.name;
  }

  fill(value) {
    this.build();
    for (const each of this.#controls) each.fill(value?.[each.name]);
    this.element.open = value !== undefined;
  }
}

/** Messages in a list. */
class List {
  #field;
  #path;
  #items = [];
  #list = element("div", { className: "group" });
  #add = element("button", { type: "button" }, say("field.add"));

  constructor(field, path) {
    this.#field = field;
    this.name = field.name;
    this.#path = `${path} ${field.name}`.trim();
    this.#add.onclick = () => {
      this.#append().element.querySelector("input, select, textarea, summary")?.focus();
      this.#change();
    };
    this.element = element("details", {}, element("summary", { title: field.about }, `${field.name} (${counted(field)})`), this.#list, this.#add);
    for (let count = 0; count < Math.min(field.least, MOST_ITEMS); count += 1) this.#append();
  }

  json() {
    const texts = this.#items.map((each) => each.json() ?? "{}");
    if (!texts.length || (texts.length === this.#field.least && texts.every((each) => each === "{}"))) return undefined;
    return `[${texts.join(",")}]`;
  }

  fill(value) {
    while (this.#items.length > this.#field.least) this.#remove(this.#items.at(-1));
    for (const [index, each] of (value ?? []).entries()) (this.#items[index] ?? this.#append()).fill(each);
    this.element.open = value !== undefined;
  }

  /** Report that the message has changed, as a field does while the user types. */
  #change() {
    this.element.dispatchEvent(new Event("input", { bubbles: true }));
  }

  #append() {
    const item = new Group({ ...this.#field.item, name: `${this.#items.length}` }, this.#path);
    const remove = element("button", { type: "button", aria: { label: say("field.remove", { name: this.name, index: this.#items.length }) } }, "✕");
    remove.onclick = () => {
      this.#remove(item);
      this.#change();
    };
    item.row = element("div", { className: "item" }, item.element, remove);
    remove.hidden = this.#items.length < this.#field.least;
    item.element.open = true;
    item.build(); // now, for the focus
    this.#items.push(item);
    this.#list.append(item.row);
    this.#bound();
    return item;
  }

  #remove(item) {
    this.#items.splice(this.#items.indexOf(item), 1);
    item.row.remove();
    this.#bound();
  }

  #bound() {
    this.#add.disabled = this.#items.length >= Math.min(this.#field.most ?? MOST_ITEMS, MOST_ITEMS);
  }
}

/** One value, or several in one line. */
class Value {
  #field;
  #input;
  #problem = element("small", { className: "problem", role: "alert" });

  constructor(field, path) {
    this.#field = field;
    this.name = field.name;
    this.#input = inputOf(field);
    this.#input.setAttribute("aria-label", `${path} ${field.name}`.trim());
    this.#input.oninput = () => this.#check(); // not on a change: a line that appears under a click moves what was to be clicked
    const title = element("span", { title: field.about }, field.name);
    this.element = element("label", { className: "value" }, title, this.#input, this.#problem);
  }

  json() {
    const text = this.#check();
    if (text instanceof Error) {
      this.#input.focus();
      throw new Error(`${this.name}: ${text.message}`, { cause: text });
    }
    return text;
  }

  fill(value) {
    this.#input.value = written(this.#field, value);
    this.#check();
  }

  /** Return the JSON, or the error, and show the latter. */
  #check() {
    let found;
    try {
      found = jsonOf(this.#field, this.#input.value);
    } catch (error) {
      found = error;
    }
    const isWrong = found instanceof Error;
    this.#problem.textContent = isWrong ? found.message : "";
    this.#input.setAttribute("aria-invalid", isWrong);
    return found;
  }
}

function controlOf(field, path) {
  if (field.kind === "group") return new Group(field, path);
  return field.kind === "list" ? new List(field, path) : new Value(field, path);
}

let lists = 0;

function inputOf(field) {
  if (field.kind === "boolean") {
    const choice = element("select");
    for (const each of ["", "true", "false"]) choice.append(new Option(each || say("field.default", { value: field.fallback ?? false }), each));
    return choice;
  }
  if (field.kind === "row" && field.item.kind === "text") return element("textarea", { rows: 2, placeholder: expected(field) });
  const input = element("input", { type: "text", placeholder: expected(field), autocomplete: "off", spellcheck: false });
  if (field.kind === "time") input.value = "now";
  if (field.constants) {
    const names = element("datalist", { id: `constants-${lists++}` });
    for (const [name, value] of Object.entries(field.constants)) names.append(new Option(`${name} = ${value}`, value));
    input.append(names);
    input.setAttribute("list", names.id);
  }
  return input;
}
