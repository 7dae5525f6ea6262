// SPDX-License-Identifier: Apache-2.0
import { element } from "../shared/dom.js";
import { say } from "../shared/language.js";
import { Choice, fieldOf, NUMBER_TYPES } from "./choice.js";
import { asked, isNumber, valueAt, written } from "./numbers.js";
import { unitOf } from "./units.js";

const LONG = 24; // characters: more are written smaller
const MOST_CHARACTERS = 10_000;

/** One field in large letters: a number with its unit, or a text. */
export class ValueView {
  static title = say("view.value");
  static types = [...NUMBER_TYPES, "std_msgs/msg/String"];
  static isForAll = true;

  rest = 100;
  element = element("div");
  #path;
  #unit;
  #choice = null;
  #value = element("strong", { className: "big" });
  #name = element("p", { className: "quiet" });

  constructor(card) {
    this.#path = fieldOf(card);
    this.#unit = unitOf(card.type, this.#path);
    if (!this.#path) this.#choice = new Choice(this.element, say("choose.field"), (path) => card.choose(path));
    else this.element.append(this.#value, this.#name);
    this.#name.textContent = this.#path;
  }

  /** Whether it may not ask once it knows the type. */
  get isUnsure() {
    return this.#choice !== null;
  }

  get options() {
    return this.#choice?.options ?? { throttle_rate: 100, fields: [asked(this.#path)] };
  }

  show(message) {
    if (this.#choice) return this.#choice.show(message);
    const value = valueAt(message, this.#path);
    const text = isNumber(value) ? `${written(typeof value === "string" ? Number(value) : value)} ${this.#unit}`.trim() : String(value ?? "–").slice(0, MOST_CHARACTERS);
    this.#value.classList.toggle("long", text.length > LONG);
    if (this.#value.textContent !== text) this.#value.textContent = text;
  }
}
