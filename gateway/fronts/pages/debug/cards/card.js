// SPDX-License-Identifier: Apache-2.0
import { breakable, element } from "../../shared/dom.js";

/**
 * The content of a card, as the address of the page keeps it. It is a name of the ROS graph in a view, at a rate. A plot also has its fields,
 * and a topic with several types the chosen one.
 * @typedef {{topic: string, view: string, fields: string[], rate: number, chosenType?: string}} Shown
 */

/**
 * The requests of a card to the page.
 * @typedef {{changed: () => void, close: (card: Card) => void, open: (name: string, view?: string, fields?: string[]) => void, grown: (card: Card) => void}} Actions
 */

/** The frame of everything that lies on the page: a title with controls, what is wrong, a body and a footer. */
export class Card {
  /** @type {string} */ topic;
  /** @type {string} */ view;
  /** @type {string[]} */ fields;
  /** @type {number} */ rate;
  /** @type {string} */ chosenType = "";
  body = element("div", { className: "body" });
  footer = element("footer");
  /** Whether it is on the screen: nobody needs to draw the others. */
  isSeen = false;
  #type = element("small", { className: "type" });
  #observer = new IntersectionObserver((entries) => (this.isSeen = entries.at(-1).isIntersecting));
  problem = element("p", { className: "problem", hidden: true, role: "status" });

  /**
   * @param {import("../../shared/gateway.js").Gateway} gateway
   * @param {Shown} shown
   * @param {Actions} actions
   * @param {{label?: string, title?: string, type?: string}} [words] by default those of the name that is shown
   */
  constructor(gateway, shown, actions, { label = shown.topic, title = shown.topic, type = "" } = {}) {
    /** For a view that needs more than its topic. */
    this.gateway = gateway;
    this.actions = actions;
    Object.assign(this, shown);
    this.controls = element("div", { className: "controls" });
    const close = element("button", { type: "button", aria: { label: `close ${label}` } }, "✕");
    close.onclick = () => actions.close(this);
    const header = element("header", {}, element("h3", {}, breakable(title)), this.controls, close, this.#type);
    this.writeType(type);
    this.element = element("article", { className: "card", tabIndex: -1, aria: { label } }, header, this.problem, this.body, this.footer);
    this.#observer.observe(this.element);
  }

  /** The part of it that the address of the page keeps. */
  get shown() {
    const { topic, view, fields, rate, chosenType } = this;
    return { topic, view, fields, rate, chosenType };
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

  close() {
    this.#observer.disconnect();
    this.element.remove();
  }
}
