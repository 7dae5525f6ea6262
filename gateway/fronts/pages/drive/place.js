// SPDX-License-Identifier: Apache-2.0
import { Aging } from "../shared/aging.js";
import { element } from "../shared/dom.js";
import { say } from "../shared/language.js";
import { missing, named, published } from "../shared/named_topics.js";
import { lasting, OF_SILENCE } from "../shared/passing.js";

/** A part of the page that shows one topic, pale while it is old, with what is wrong with it in words. */
export class Place {
  #home;
  #gateway;
  #view = null;
  #unsubscribe = () => {};
  #failures = new Map(); // by what has failed, in words
  #ofMessage = ""; // the gateway's words about the newest message
  #aging;
  #newest = null; // message
  #problem = element("p", { className: "problem", role: "status", hidden: true });

  /**
   * @param {HTMLElement} home that holds it
   * @param {import("../shared/gateway.js").Gateway} gateway
   * @param {Object<string, number>} [lateMs] as for `Aging`
   */
  constructor(home, gateway, lateMs) {
    this.#home = home;
    this.#gateway = gateway;
    this.#aging = new Aging(home, lateMs);
    addEventListener("themechange", () => this.#recolour());
  }

  /** The view, or null. */
  get view() {
    return this.#view;
  }

  /** The arrivals of its topic, or undefined. */
  get arrivals() {
    return this.#gateway.arrivals.get(this.#view?.topic);
  }

  /** Show a topic in the first of some views, each with its kind, that the address or else the robot has something for. Or say what is missing. */
  show(nothing, ...views) {
    const { graph } = this.#gateway;
    const [View, kind] = views.find(([, each]) => named(each) || published(graph, each)) ?? [];
    const topic = View && published(graph, kind);
    if (!topic && !this.#view) this.#home.replaceChildren(element("p", {}, View ? missing(graph, kind) : nothing));
    if (!topic || (this.#view instanceof View && (this.#view.topic === topic || !named(kind)))) return;
    this.#end();
    const view = new View({ topic, gateway: this.#gateway, tell: (words) => this.#tell(words), untell: (words) => this.#untell(words) });
    view.topic = topic;
    this.#view = view;
    this.#unsubscribe = this.#gateway.subscribe(topic, view.options, (message) => this.#take(message), (status) => this.#status(status));
    this.#home.replaceChildren(view.element, this.#problem);
  }

  /** Draw what has changed. Called before each frame of the screen. */
  draw() {
    this.#attempt("drawing", () => this.#view?.draw?.());
  }

  /** Write how old it is, by what it is made of: call it some times a second. */
  write(sources, isConnected) {
    this.#aging.write(sources, isConnected);
  }

  #end() {
    this.#unsubscribe();
    this.#view?.close?.();
    this.#newest = null;
    this.#tell("");
  }

  /** Show the same again: a canvas keeps the colours that it was painted in. */
  #recolour() {
    if (!this.#newest) return;
    this.#attempt("showing", () => (this.#view.recolour ? this.#view.recolour() : this.#view.show(this.#newest)));
  }

  #take(message) {
    this.#untell(this.#ofMessage);
    this.#ofMessage = "";
    this.#newest = message;
    this.#attempt("showing", () => this.#view.show(message));
  }

  #status(status) {
    if (OF_SILENCE.includes(status.code)) this.#ofMessage = status.msg;
    lasting((words) => this.#tell(words))(status);
  }

  /** Say what cannot be shown, until it can be, and go on: the page has to drive, and to stop. */
  #attempt(what, action) {
    try {
      action();
      if (this.#failures.has(what)) this.#untell(this.#failures.get(what));
      this.#failures.delete(what);
    } catch (error) {
      this.#failures.set(what, say("drive.failed", { why: error.message }));
      this.#tell(this.#failures.get(what));
    }
  }

  #tell(words) {
    if (this.#problem.textContent === words) return; // it is read out
    this.#problem.textContent = words;
    this.#problem.hidden = !words;
  }

  #untell(words) {
    if (this.#problem.textContent === words) this.#tell("");
  }
}
