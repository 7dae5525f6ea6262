// SPDX-License-Identifier: Apache-2.0
import { Arrivals } from "../shared/arrivals.js";
import { element } from "../shared/dom.js";
import { json } from "../shared/json.js";
import { makeView, nameOf, viewsFor } from "./views/views.js";

const RATES_HZ = [0, 30, 10, 5, 1]; // 0: as the robot publishes

/**
 * What is shown: a topic by a view, at a rate, of a plot its fields.
 * @typedef {{topic: string, view: string, fields: string[], rate: number}} Shown
 */

/** One topic in one view, with what the gateway says of it. */
export class Card {
  #actions;
  #view;
  #unsubscribe = () => {};
  #newest = null;
  #isPaused = false;
  #isDirty = false;
  #arrivals = new Arrivals();
  #body = element("div", { className: "body" });
  #problem = element("p", { className: "problem", hidden: true, role: "status" });
  #footer = element("footer", {}, "nothing yet");
  #pause = element("button", { type: "button", aria: { pressed: "false" } }, "Pause");

  /**
   * @param {import("../shared/gateway.js").Gateway} gateway
   * @param {Shown} shown
   * @param {string} type of the topic, "" if nobody publishes it
   * @param {{changed: () => void, close: (card: Card) => void, plot: (topic: string, path: string) => void}} actions
   */
  constructor(gateway, shown, type, actions) {
    /** For a view that needs more than its topic. */
    this.gateway = gateway;
    this.#actions = actions;
    Object.assign(this, shown);
    this.type = type;
    this.element = element("article", { className: "card", aria: { label: this.topic } });
    this.element.append(this.#header(), this.#problem, this.#body, this.#footer);
    this.#start();
  }

  /** What the address of the page keeps of it. */
  get shown() {
    const { topic, view, fields, rate } = this;
    return { topic, view, fields, rate };
  }

  /** Plot one of its numbers, in a card beside. */
  plot(path) {
    this.#actions.plot(this.topic, path);
  }

  /** Say what is wrong with what it shows. */
  tell(text) {
    this.#problem.textContent = text;
    this.#problem.hidden = false;
  }

  /** Draw what has come since the last frame of the screen. */
  draw() {
    if (this.#isPaused) return;
    if (this.#isDirty) this.#view.show(this.#newest.message, this.#newest.frame);
    this.#isDirty = false;
    this.#view.draw?.();
  }

  /** Write rate, size and age; called once a second. */
  tick() {
    this.#arrivals.tick();
    this.element.classList.toggle("stale", this.#arrivals.isLate);
    this.#footer.textContent = this.#arrivals.words;
  }

  close() {
    this.#unsubscribe();
    this.#view.close?.();
    this.element.remove();
  }

  #header() {
    const views = element("select", { title: "how it is shown", aria: { label: "view" } });
    for (const key of new Set([this.view, ...viewsFor(this.type)])) views.append(new Option(nameOf(key), key, false, key === this.view));
    views.onchange = () => this.#restart({ view: views.value });
    const rates = element("select", { title: "at most so many messages a second", aria: { label: "rate" } });
    for (const hz of RATES_HZ) rates.append(new Option(hz ? `${hz} Hz` : "all", hz, false, hz === this.rate));
    rates.onchange = () => this.#restart({ rate: Number(rates.value) });
    this.#pause.onclick = () => {
      this.#isPaused = !this.#isPaused;
      this.#pause.setAttribute("aria-pressed", this.#isPaused);
    };
    const copy = element("button", { type: "button", title: "copy the newest message as JSON" }, "Copy");
    copy.onclick = () => this.#copy();
    const close = element("button", { type: "button", aria: { label: `close ${this.topic}` } }, "✕");
    close.onclick = () => this.#actions.close(this);
    return element("header", {}, element("h3", { title: this.type }, this.topic), views, rates, this.#pause, copy, close);
  }

  async #copy() {
    try {
      await navigator.clipboard.writeText(json(this.#newest?.message ?? null, 2));
    } catch (error) {
      this.tell(`not copied: ${error.message}`);
    }
  }

  #restart(changed) {
    Object.assign(this, changed);
    this.#start();
    this.#actions.changed();
  }

  #start() {
    this.#unsubscribe();
    this.#view?.close?.();
    this.#problem.hidden = true;
    this.#isDirty = false;
    this.#view = makeView(this.view, this);
    this.#body.replaceChildren(this.#view.element);
    if (this.view === "plot") this.#view.show(); // before there is a message it says what to do
    const { throttle_rate: least = 0, ...options } = this.#view.options;
    const throttle = Math.max(least, this.rate ? Math.round(1000 / this.rate) : 0);
    this.#unsubscribe = this.gateway.subscribe(
      this.topic,
      { ...options, throttle_rate: throttle },
      (message, size, frame) => this.#receive(message, size, frame),
      (status) => this.#status(status),
    );
  }

  #receive(message, size, frame) {
    this.#arrivals.add(size, frame);
    this.#newest = { message, frame };
    this.#isDirty = true;
    if (this.#isPaused) return;
    this.#view.keep?.(message);
    if (this.#problem.dataset.code === "not_found") this.#problem.hidden = true; // somebody publishes now
  }

  #status(status) {
    this.#problem.dataset.code = status.code ?? "";
    this.tell(status.msg);
  }
}
