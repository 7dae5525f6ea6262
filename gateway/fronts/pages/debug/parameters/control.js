// SPDX-License-Identifier: Apache-2.0
import { element } from "../../shared/dom.js";
import { json } from "../../shared/json.js";
import { say } from "../../shared/language.js";
import { valueOf } from "../forms/typed.js";
import { choicesOf } from "./choices.js";

/** The event when the node has another value. */
export const TAKEN = "taken";
const MOST_STEPS = 10_000; // of a slider: more are not seen

/**
 * The gateway's words about a parameter, and its value.
 * @typedef {{type?: string, description?: string, additional_constraints?: string, read_only?: boolean, range?: {from: any, to: any, step: any}}} About
 */

/** One parameter that can be set: a checkbox, a slider, a choice, or a text. */
export class Control {
  /** Whether the node has another value than at the start. */
  isChanged = false;
  #name;
  #type;
  #set;
  #first; // JSON texts of the value: at the start,
  #newest; // and as the node has it
  #input;
  #slider = null;
  #problem = element("small", { className: "problem", role: "alert" });
  #undo = element("button", { type: "button", hidden: true, title: say("parameters.undo") }, "↺");

  /**
   * @param {string} name
   * @param {string} title the part of the name that is shown
   * @param {any} value
   * @param {About} about
   * @param {(name: string, text: string) => Promise<string>} set returns why the node refuses it, or ""
   */
  constructor(name, title, value, about, set) {
    const { type = "", description = "", additional_constraints: constraints = "", read_only: isFixed = false, range } = about;
    this.#name = name;
    this.#type = type;
    this.#set = set;
    this.#first = this.#newest = json(value);
    this.isFixed = isFixed;
    this.about = about;
    this.#input = this.#inputOf(value, choicesOf(constraints), isFixed);
    this.#input.setAttribute("aria-label", name);
    this.#input.onchange = () => this.#change(this.#text);
    this.#undo.setAttribute("aria-label", say("parameters.undo.of", { name }));
    this.#undo.onclick = () => this.#change(this.#first);
    const words = [type, range ? say("range", { least: range.from, most: range.to }) : "", constraints, isFixed ? say("parameters.fixed") : ""].filter(Boolean).join(", ");
    const label = element("label", { className: "value" }, element("span", { title: [name, description].filter(Boolean).join(": ") }, title, element("small", {}, ` ${words}`)), this.#input, this.#problem);
    this.element = element("div", { className: "parameter" }, label, this.#undo);
    if (range && !isFixed) this.#slide(range);
    this.#write();
  }

  /** The value as the node has it, as JSON. */
  get json() {
    return this.#newest;
  }

  /** Show a value that the node has by now. */
  take(text) {
    this.#newest = text;
    this.isChanged = text !== this.#first;
    this.#undo.hidden = !this.isChanged;
    this.element.classList.toggle("changed", this.isChanged);
    this.#write();
    this.element.dispatchEvent(new Event(TAKEN, { bubbles: true }));
  }

  /** Say why it was not set, or nothing. */
  tell(words) {
    this.#problem.textContent = words;
  }

  #inputOf(value, choices, isFixed) {
    if (this.#type === "bool") return element("input", { type: "checkbox", disabled: isFixed });
    if (choices.length && ["string", "integer", "double"].includes(this.#type)) {
      const known = choices.includes(String(value)) ? choices : [String(value), ...choices];
      return element("select", { disabled: isFixed }, ...known.map((each) => new Option(each)));
    }
    return element("input", { type: "text", readOnly: isFixed, autocomplete: "off", spellcheck: false });
  }

  /** Add a slider between two ends, if a slider can have them. */
  #slide({ from, to, step }) {
    const [min, max, each] = [from, to, step].map(Number);
    if (!(max > min) || !Number.isFinite(max - min)) return;
    const isWhole = this.#type === "integer";
    const least = (max - min) / MOST_STEPS;
    this.#slider = element("input", { type: "range", min, max, step: each > least ? each : isWhole ? Math.max(1, Math.round(least)) : "any", aria: { label: say("parameters.slider", { name: this.#name }) } });
    this.#slider.oninput = () => (this.#input.value = this.#slider.value);
    this.#slider.onchange = () => this.#change(this.#text);
    this.element.append(this.#slider);
  }

  /** The choice of the user, as JSON. */
  get #text() {
    if (this.#type === "bool") return String(this.#input.checked);
    return this.#type === "string" ? JSON.stringify(this.#input.value) : this.#input.value;
  }

  async #change(text) {
    this.tell("");
    try {
      valueOf(text);
    } catch (error) {
      this.tell(error.cause ? say("parameters.json") : error.message);
      return;
    }
    const problem = await this.#set(this.#name, text);
    this.tell(problem);
    if (!problem) this.take(text);
    else if (this.#type === "bool") this.#write(); // it shows what the node has
  }

  #write() {
    const value = JSON.parse(this.#newest);
    if (this.#type === "bool") this.#input.checked = value;
    else this.#input.value = this.#type === "string" || this.#input instanceof HTMLSelectElement ? String(value) : this.#newest;
    if (this.#slider) this.#slider.value = String(value);
  }
}
