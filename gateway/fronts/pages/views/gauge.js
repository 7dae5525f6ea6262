// SPDX-License-Identifier: Apache-2.0
import { element } from "../shared/dom.js";
import { say } from "../shared/language.js";
import { Choice, fieldOf, NUMBER_TYPES } from "./choice.js";
import { asked, isNumber, valueAt, written } from "./numbers.js";
import { unitOf } from "./units.js";

const FROM_0_TO_1 = ["percentage", "relative_humidity"];
const SHAPE = "http://www.w3.org/2000/svg";
const ARC = "M 10 60 A 50 50 0 0 1 110 60";

/** One number on a dial, between two ends. An end that is not set grows with the values. */
export class GaugeView {
  static title = say("view.gauge");
  static types = NUMBER_TYPES;
  static isForAll = true;

  rest = 66;
  element = element("div", { className: "gauge" });
  #path;
  #unit;
  #choice = null;
  #way = shape("path", { d: ARC, class: "on", pathLength: "100" });
  #value = element("strong", { className: "big" });
  #ends; // low and high: what the user has set, or else what is shown
  #seen = { low: 0, high: 0 }; // round numbers around the values so far

  constructor(card) {
    this.#path = fieldOf(card);
    this.#unit = unitOf(card.type, this.#path);
    if (FROM_0_TO_1.includes(this.#path.split(".").at(-1))) this.#seen.high = 1;
    if (!this.#path) {
      this.#choice = new Choice(this.element, say("choose.number"), (path) => card.choose(path));
      return;
    }
    const picture = shape("svg", { viewBox: "0 0 120 66", "aria-hidden": "true" }, shape("path", { d: ARC, class: "off" }), this.#way);
    this.#ends = Object.fromEntries(["low", "high"].map((name) => [name, input(card, name)]));
    const ends = Object.entries(this.#ends).map(([name, its]) => element("label", {}, `${say(`ends.${name}`)} `, its));
    this.element.append(picture, this.#value, element("p", { className: "quiet" }, this.#path), element("div", { className: "tools" }, ...ends));
  }

  /** Whether it may not ask once it knows the type. */
  get isUnsure() {
    return this.#choice !== null;
  }

  get options() {
    return this.#choice?.options ?? { throttle_rate: 66, fields: [asked(this.#path)] };
  }

  show(message) {
    if (this.#choice) return this.#choice.show(message);
    const value = Number(valueAt(message, this.#path) ?? NaN);
    if (!isNumber(valueAt(message, this.#path))) throw new TypeError(say("number.none", { path: this.#path }));
    this.#value.textContent = `${written(value)} ${this.#unit}`.trim();
    if (!Number.isFinite(value)) return;
    this.#seen = { low: Math.min(this.#seen.low, -above(-value)), high: Math.max(this.#seen.high, above(value)) };
    const [low, high] = Object.entries(this.#ends).map(([name, its]) => {
      its.placeholder = String(this.#seen[name]);
      return its.value === "" || Number.isNaN(its.valueAsNumber) ? this.#seen[name] : its.valueAsNumber;
    });
    const share = high > low ? Math.max(0, Math.min(1, (value - low) / (high - low))) : 0;
    this.#way.setAttribute("stroke-dasharray", `${share * 100} 200`);
    this.#way.classList.toggle("beyond", value < low || value > high);
  }
}

/** Return a field for an end of the dial, which the card keeps. */
function input(card, name) {
  const made = element("input", { type: "number", step: "any", value: card.settings[name] ?? "", aria: { label: say(`ends.${name}.of`, { topic: card.topic }) } });
  made.onchange = () => card.keep(name, made.value);
  return made;
}

/** Return the next of 1, 2 and 5 of a power of ten that is at least a number. 0 for one that is not positive. */
function above(value) {
  if (!(value > 0)) return 0;
  const power = 10 ** Math.floor(Math.log10(value));
  return Number(([1, 2, 5, 10].find((each) => each * power >= value) * power).toPrecision(1));
}

function shape(name, attributes, ...children) {
  const made = document.createElementNS(SHAPE, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}
