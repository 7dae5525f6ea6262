// SPDX-License-Identifier: Apache-2.0
import { breakable, element } from "../../shared/dom.js";
import { isTaken } from "../../shared/keys.js";
import { say } from "../../shared/language.js";
import { menu } from "../../shared/menu.js";
import { Demand } from "../demand.js";
import { movable } from "../moving.js";
import { resizable, resize } from "../resizing.js";

/**
 * The content of a card, as the address of the page keeps it. It is a name of the ROS graph in a view, at a rate. A plot also has its fields,
 * and a topic with several types the chosen one. A view has its settings by name, and keeps only those that differ from the usual.
 * A card that was resized has its size, in twelfths of the width and in rows.
 * @typedef {{topic: string, view: string, fields: string[], rate: number, chosenType?: string, settings?: Object<string, string>, wide?: number, tall?: number}} Shown
 */

/**
 * The requests of a card to the page. `move` gives the card another place: before another card, or by so many places.
 * @typedef {{changed: () => void, close: (card: Card) => void, open: (name: string, view?: string, fields?: string[]) => void, grown: (card: Card) => void,
 *   move: (card: Card, where: number|{before: Element|null}) => void, maximise: (card: Card, isOnScreen?: boolean) => void, tabs: (card: Card) => import("../../shared/menu.js").Entry[]}} Actions
 */

/** The frame of everything that lies on the page: a title with controls, what is wrong, a body and a footer. */
export class Card {
  /** @type {string} */ topic;
  /** @type {string} */ view;
  /** @type {string[]} */ fields;
  /** @type {number} */ rate;
  /** @type {string} */ chosenType = "";
  /** @type {Object<string, string>} */ settings = {};
  /** Twelfths of the width. 0: as the style has it. */ wide = 0;
  /** Rows. 0: as the style has it. */ tall = 0;
  body = element("div", { className: "body" });
  footer = element("footer");
  /** Whether it is on the screen: nobody needs to draw the others. */
  isSeen = false;
  /** Whether it fills the page, below the bar with STOP. */
  isFull = false;
  #fullTakes = new Set();
  #demand;
  #type = element("small", { className: "type" });
  #observer = new IntersectionObserver((entries) => (this.isSeen = entries.at(-1).isIntersecting));
  problem = element("p", { className: "problem", hidden: true, role: "status" });

  /**
   * @param {import("../../shared/gateway.js").Gateway} gateway
   * @param {Shown} shown
   * @param {Actions} actions
   * @param {{title?: string, type?: string}} [words] by default the name that is shown
   */
  constructor(gateway, shown, actions, { title = shown.topic, type = "" } = {}) {
    this.#demand = new Demand(gateway);
    /** For a view that needs more than its topic. */
    this.gateway = this.#demand.gateway;
    this.actions = actions;
    Object.assign(this, shown);
    this.controls = element("div", { className: "controls" });
    const close = element("button", { type: "button", className: "ghost", aria: { label: say("card.close", { label: title }) } }, "✕");
    close.onclick = () => actions.close(this);
    const more = menu(say("card.more", { label: title }), () => [...this.entries(), ...this.#places()]);
    const corner = element("span", { className: "corner" }, more, close);
    const header = element("header", {}, element("h3", {}, breakable(title)), this.controls, corner, this.#type);
    header.ondblclick = ({ target }) => target.closest("button, select, label, input") || actions.maximise(this);
    this.writeType(type);
    const grip = resizable(this, say("card.resize", { label: title }));
    this.element = element("article", { className: "card", tabIndex: -1, aria: { label: title } }, header, this.problem, this.body, this.footer, grip);
    this.element.addEventListener("keydown", (event) => this.#press(event));
    movable(this.element, header, (before) => actions.move(this, { before }));
    resize(this, this.wide, this.tall);
    this.#observer.observe(this.element);
  }

  /** The part of it that the address of the page keeps. */
  get shown() {
    const { topic, view, fields, rate, chosenType, settings, wide, tall } = this;
    return { topic, view, fields, rate, chosenType, settings, wide, tall };
  }

  /** Return rare actions, for its menu. @returns {import("../../shared/menu.js").Entry[]} */
  entries() {
    return [];
  }

  /** Return the entries about its place. */
  #places() {
    return [
      { label: this.isFull ? say("card.restore") : say("card.maximise"), key: "m", act: () => this.actions.maximise(this) },
      { label: say("card.earlier"), key: "[", act: () => this.actions.move(this, -1) },
      { label: say("card.later"), key: "]", act: () => this.actions.move(this, 1) },
      { label: say("card.usual"), act: () => this.#resize(0, 0), isOff: !this.wide && !this.tall },
      ...this.actions.tabs(this),
    ];
  }

  #resize(wide, tall) {
    resize(this, wide, tall);
    this.actions.changed();
  }

  #press(event) {
    const { key, target, defaultPrevented } = event;
    if (defaultPrevented || isTaken(event) || event.ctrlKey || event.altKey || event.metaKey || target.matches("[role=application]")) return;
    if (key === "m") this.actions.maximise(this);
    else if (key === "[" || key === "]") this.actions.move(this, key === "[" ? -1 : 1);
  }

  /** Keep a setting of the view in the address. The usual value leaves it out. */
  keep(name, value, usual = "") {
    const { [name]: _, ...others } = this.settings;
    this.settings = String(value) === String(usual) ? others : { ...others, [name]: String(value) };
    this.actions.changed();
  }

  /** Fill the page, and the whole screen where the browser can, or end that. */
  fill() {
    this.actions.maximise(this, true);
  }

  /** Fill the page, or not: the desk sees to the other cards. */
  setFull(isFull) {
    this.isFull = isFull;
    for (const take of this.#fullTakes) take(isFull);
  }

  /** Hear when it fills the page, and when not any more, until the function that this returns is called. @param {(isFull: boolean) => void} take */
  onFull(take) {
    this.#fullTakes.add(take);
    return () => this.#fullTakes.delete(take);
  }

  /** Write below the title which type is shown, if any is known. */
  writeType(type) {
    this.#type.replaceChildren(breakable(type));
    this.#type.hidden = !type;
  }

  /** Say what is wrong, or nothing. The code is the gateway's, if it says so. */
  tell(text, code = "") {
    this.problem.dataset.code = code;
    this.problem.textContent = text;
    this.problem.hidden = !text;
  }

  /** Say it no longer, if it is still what is said. */
  untell(text) {
    if (this.problem.textContent === text) this.tell("");
  }

  /**
   * Draw what has come since the last frame of the screen.
   * @param {number} _ms when this frame began, the same for all cards
   */
  draw(_ms) {}

  /** Write what changes with time. Called once a second. */
  tick() {}

  /** Whether it asks for nothing, because nobody sees it. */
  get isResting() {
    return this.#demand.isResting;
  }

  /** Whether it goes on while the browser shows another page, because it collects what comes. */
  get isCollecting() {
    return false;
  }

  /** Ask for nothing. */
  rest() {
    this.#demand.rest();
  }

  /** Go on, because it is seen again. */
  wake() {
    this.#demand.wake();
  }

  close() {
    this.#observer.disconnect();
    this.element.remove();
  }
}
