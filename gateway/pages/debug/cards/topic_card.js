// SPDX-License-Identifier: Apache-2.0
import { Arrivals } from "../../shared/arrivals.js";
import { element } from "../../shared/dom.js";
import { json } from "../../shared/json.js";
import { makeView, misfit, nameOf, viewsFor } from "../../views/views.js";
import { Card } from "./card.js";

const RATES_HZ = [0, 30, 10, 5, 1]; // 0: as the robot publishes
const SILENCE = ["not_found", "publisher_gone", "liveliness_lost", "deadline_missed", "stale"]; // what is over with the next message

/** One topic in one view, with what the gateway says of it. */
export class TopicCard extends Card {
  #type;
  #view;
  #unsubscribe = () => {};
  #newest = null;
  #isPaused = false;
  #isDirty = false;
  #shownBeat = -1; // of the `rest` of its view
  #arrivals = new Arrivals();

  constructor(gateway, shown, actions) {
    const type = gateway.graph.typeOf(shown.topic);
    super(gateway, shown, actions, { hint: type });
    this.#type = type;
    this.controls.append(...this.#controls());
    this.footer.textContent = this.#arrivals.words;
    this.#start();
  }

  /** Plot one of its numbers, in a card beside. */
  plot(path) {
    this.actions.open(this.topic, "plot", [path]);
  }

  draw(ms) {
    if (this.#isPaused) return;
    // in step with other cards: to compose a frame in which anything has changed costs the browser more than one view does
    const beat = Math.floor(ms / (this.#view.rest ?? 1));
    if (this.#isDirty && beat !== this.#shownBeat) {
      this.#view.show(this.#newest.message, this.#newest.frame);
      this.#isDirty = false;
      this.#shownBeat = beat;
    }
    this.#view.draw?.();
  }

  tick() {
    this.#arrivals.tick();
    this.#write();
  }

  close() {
    this.#unsubscribe();
    this.#view.close?.();
    super.close();
  }

  #write() {
    this.element.classList.toggle("stale", this.#arrivals.isLate);
    this.footer.textContent = this.#isPaused ? "paused" : this.#arrivals.words + this.#cap;
  }

  /** The most messages a second that this page asks of the topic, in words: the view has a share in that, too. */
  get #cap() {
    const throttle = this.gateway.throttleOf(this.topic);
    return throttle && this.#arrivals.messages ? ` · at most ${Math.round(10_000 / throttle) / 10} Hz, by choice` : "";
  }

  #controls() {
    const views = element("select", { title: "how it is shown", aria: { label: `view of ${this.topic}` } });
    for (const key of new Set([this.view, ...viewsFor(this.#type)])) views.append(new Option(nameOf(key), key, false, key === this.view));
    views.onchange = () => this.#restart({ view: views.value });
    const rates = element("select", { title: "at most so many messages a second", aria: { label: `rate of ${this.topic}` } });
    for (const hz of RATES_HZ) rates.append(new Option(hz ? `${hz} Hz` : "all", String(hz), false, hz === this.rate));
    rates.onchange = () => this.#restart({ rate: Number(rates.value) });
    const pause = element("button", { type: "button", aria: { label: `Pause ${this.topic}` } }, "Pause");
    pause.onclick = () => {
      this.#isPaused = !this.#isPaused;
      pause.textContent = this.#isPaused ? "Resume" : "Pause";
      pause.setAttribute("aria-label", `${pause.textContent} ${this.topic}`);
      this.#write();
    };
    const copy = element("button", { type: "button", title: "copy the newest message as JSON", aria: { label: `Copy ${this.topic}` } }, "Copy");
    copy.onclick = () => this.#copy();
    return [views, rates, pause, copy];
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
    this.actions.changed();
  }

  #start() {
    this.#unsubscribe();
    this.#view?.close?.();
    this.#status({ msg: "" });
    this.#isDirty = false;
    this.#view = makeView(this.view, this);
    this.body.replaceChildren(this.#view.element);
    if (this.view === "plot") this.#view.show(); // before there is a message it says what to do
    const problem = misfit(this.view, this.#type);
    this.#unsubscribe = () => {};
    this.tell(problem);
    if (problem) return;
    const { throttle_rate: least = 0, ...options } = this.#view.options;
    const throttle = Math.max(least, this.rate ? Math.round(1000 / this.rate) : 0);
    this.#unsubscribe = this.gateway.subscribe(
      this.topic,
      { ...options, throttle_rate: throttle },
      (message, size, frame, dropped) => this.#receive(message, size, frame, dropped),
      (status) => this.#status(status),
    );
  }

  #receive(message, size, frame, dropped) {
    this.#arrivals.add(size, dropped);
    this.#newest = { message, frame };
    this.#isDirty = true;
    if (SILENCE.includes(this.problem.dataset.code)) this.#status({ msg: "" }); // somebody publishes now
    if (this.#isPaused) return;
    this.#view.keep?.(message);
  }

  #status({ msg, code = "" }) {
    this.problem.dataset.code = code;
    this.tell(msg);
  }
}
