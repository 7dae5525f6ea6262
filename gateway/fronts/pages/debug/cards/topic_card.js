// SPDX-License-Identifier: Apache-2.0
import { Arrivals } from "../../shared/arrivals.js";
import { element } from "../../shared/dom.js";
import { json } from "../../shared/json.js";
import { say } from "../../shared/language.js";
import { OF_SILENCE } from "../../shared/passing.js";
import { makeView, misfit, nameOf, viewsFor } from "../../views/views.js";
import { wordsOf } from "../arrival_words.js";
import { Card } from "./card.js";
import { copyButton } from "./copy_button.js";
import { sorted } from "./large_fields.js";

const RATES_HZ = [0, 30, 10, 5, 1]; // 0: as the robot publishes
const MOST_NAMES = 2; // of nodes, in a footer
const PASSING = [...OF_SILENCE, "type_conflict"]; // the next message ends these
const GONE = "publisher_gone"; // but not this: the last messages, which a rate has held back, come after it
const TRAIL_MS = 1000;
const LOSS_MS = 10_000; // the gateway tells of losses every 5 s while there are any

/** One topic in one view, with what the gateway says of it. */
export class TopicCard extends Card {
  #type;
  #view;
  #unsubscribe = () => {};
  #newest = null; // message, and the frame as it came
  #visible = null; // the same of what the view shows, which may be older
  #isPaused = false;
  #isDirty = false;
  #shownBeat = -1; // of the `rest` of its view
  #arrivals = new Arrivals();
  #views = element("select", { title: say("topic.view") });
  #types = element("select", { title: say("topic.type") });
  #isBroken = false; // the view has failed at the newest message
  #failure = ""; // the words for that
  #notCopied = ""; // likewise of a copy that has failed
  #toldMs = 0; // when the gateway said what is wrong
  #receivedMs = 0;
  #forgets;

  constructor(gateway, shown, actions) {
    const type = shown.chosenType || gateway.graph.typeOf(shown.topic);
    super(gateway, shown, actions, { type });
    this.#type = type;
    this.#forgets = [gateway.on("graph", () => this.#learn()), gateway.on("state", ({ state }) => state === "open" && this.#forgive())];
    const repaint = () => this.#repaint();
    addEventListener("themechange", repaint);
    this.#forgets.push(() => removeEventListener("themechange", repaint));
    this.controls.append(...this.#controls());
    this.footer.textContent = wordsOf(this.#arrivals);
    this.#start();
  }

  /** Plot one of its numbers, in a separate card. */
  plot(path) {
    this.actions.open(this.topic, "plot", [path]);
  }

  /** Plot one of its numbers here, where none was plotted yet. */
  choose(path) {
    this.#restart({ fields: [path] });
    this.element.focus(); // the element that had it is gone
  }

  /** Plot another number here. The plotted ones continue. */
  join(path) {
    if (!this.fields.length) return this.choose(path);
    this.fields = [...this.fields, path];
    this.#view.add();
    this.subscribe();
    this.actions.changed();
  }

  /** Return which fields of its type are small, and which may be large. None if the gateway does not know. */
  async sortedFields() {
    try {
      return sorted((await this.gateway.ask({ op: "describe", type: this.#type })).schema);
    } catch {
      return { small: [], large: [] };
    }
  }

  draw(ms) {
    if (this.#isPaused) return;
    // in step with other cards: to compose a frame in which anything has changed costs the browser more than one view does
    const beat = Math.floor(ms / (this.#view.rest ?? 1));
    const isDue = this.#isDirty && beat !== this.#shownBeat;
    if (isDue) {
      this.#isDirty = false;
      this.#shownBeat = beat;
    }
    this.#attempt(() => {
      if (isDue) this.#show();
      this.#view.draw?.();
      if (isDue && this.#failure) this.#recover();
    });
  }

  #show() {
    this.#visible = this.#newest;
    this.#view.show(this.#newest.message, this.#newest.data);
  }

  /** Show the same again in other colours: a canvas keeps those that it was painted in. */
  #repaint() {
    if (!this.#visible) return;
    const { message, data } = this.#visible;
    this.#attempt(() => (this.#view.recolour ? this.#view.recolour() : this.#view.show(message, data)));
  }

  tick() {
    this.#arrivals.tick();
    if (this.#isOver) this.#forgive();
    this.#write();
  }

  wake() {
    super.wake();
    this.#view.wake?.();
  }

  close() {
    for (const forget of this.#forgets) forget();
    this.#unsubscribe();
    this.#view.close?.();
    super.close();
  }

  get isCollecting() {
    return Boolean(this.#view.keep);
  }

  /** The type of its messages, or "" while it is unknown. */
  get type() {
    return this.#type;
  }

  /** Whether what it shows stands still. */
  get isPaused() {
    return this.#isPaused;
  }

  /** Whether what the gateway has said is over, as far as time tells. */
  get #isOver() {
    const { code } = this.problem.dataset;
    const ms = performance.now() - this.#toldMs;
    if (code === GONE) return ms > TRAIL_MS && this.#receivedMs >= this.#toldMs && this.#publishers.length > 0;
    return code === "messages_lost" && ms > LOSS_MS;
  }

  /** The nodes that publish it, as far as it is known. */
  get #publishers() {
    return this.gateway.graph.topics.get(this.topic)?.publishers ?? [];
  }

  #write() {
    const isLate = this.#arrivals.isLate && !this.#view.isIrregular;
    this.element.classList.toggle("stale", isLate || (this.#arrivals.messages > 0 && !this.gateway.isOpen));
    this.footer.textContent = this.#words;
  }

  get #words() {
    if (misfit(this.view, this.#type)) return "";
    if (this.#isPaused) return [say("topic.paused"), this.#view.held].filter(Boolean).join(": ");
    if (this.#arrivals.messages) return wordsOf(this.#arrivals) + (this.#arrivals.hasRate ? this.#cap : "");
    return this.problem.hidden ? [say("arrivals.none"), this.#reason].filter(Boolean).join(": ") : ""; // the problem may be the reason
  }

  /** Why nothing has come yet, in words: who would have to send something. */
  get #reason() {
    if (!this.gateway.graph.topics.has(this.topic)) return "";
    const publishers = this.#publishers;
    if (!publishers.length) return say("list.unpublished");
    return say("topic.silent", { names: names(publishers) });
  }

  /** Take the type, once the topic has one. The view may not fit it. */
  #learn() {
    this.#offerTypes();
    const type = this.chosenType || this.gateway.graph.typeOf(this.topic);
    if (!type || type === this.#type) return;
    const isOver = misfit(this.view, this.#type) || this.#view.isUnsure; // its words from before, or its question
    this.#type = type;
    this.writeType(type);
    this.#offer();
    if (this.problem.dataset.code === "not_found") this.#forgive(); // it is there now
    if (isOver || misfit(this.view, type)) this.#start();
  }

  /** Do something with the view. Say what it cannot show, and let other cards go on. */
  #attempt(action) {
    if (this.#isBroken) return;
    try {
      action();
    } catch (error) {
      this.#isBroken = true;
      this.#failure = say("topic.unshown", { view: nameOf(this.view), type: this.#type.split("/").at(-1) || say("topic.message"), why: error.message });
      this.tell(this.#failure);
    }
  }

  /** The most messages per second that this page asks of the topic, in words. The view also limits them. */
  get #cap() {
    const throttle = this.gateway.throttleOf(this.topic);
    return throttle ? ` · ${say("topic.limited", { hz: Math.round(10_000 / throttle) / 10 })}` : "";
  }

  #controls() {
    this.#views.setAttribute("aria-label", say("topic.view.of", { topic: this.topic }));
    this.#views.onchange = () => this.#restart({ view: this.#views.value, settings: {} });
    this.#offer();
    const rates = element("select", { title: say("topic.rate"), aria: { label: say("topic.rate.of", { topic: this.topic }) } });
    for (const hz of RATES_HZ) rates.append(new Option(hz ? `${hz} Hz` : say("topic.rate.all"), String(hz), false, hz === this.rate));
    rates.onchange = () => this.#restart({ rate: Number(rates.value) });
    const pause = element("button", { type: "button", aria: { label: `${say("topic.pause")} ${this.topic}` } }, say("topic.pause"));
    pause.onclick = () => {
      this.#isPaused = !this.#isPaused;
      this.#view.hold?.(this.#isPaused);
      pause.textContent = this.#isPaused ? say("topic.resume") : say("topic.pause");
      pause.setAttribute("aria-label", `${pause.textContent} ${this.topic}`);
      this.#write();
    };
    const copy = copyButton({ label: `${say("copy")} ${this.topic}`, title: say("topic.copy") }, () => this.#copied(), (problem) => this.#sayNotCopied(problem));
    this.#types.setAttribute("aria-label", say("topic.type.of", { topic: this.topic }));
    this.#types.onchange = () => this.#choose(this.#types.value);
    this.#offerTypes();
    return [this.#views, rates, pause, copy, this.#types];
  }

  /** Offer the views that fit the type. */
  #offer() {
    const keys = new Set([this.view, ...viewsFor(this.#type)]);
    this.#views.replaceChildren(...[...keys].map((key) => new Option(nameOf(key), key, false, key === this.view)));
  }

  /** Return what is copied: paused, what one sees. */
  #copied() {
    const copied = (this.#isPaused && this.#visible) || this.#newest;
    if (!copied) throw new Error(say("arrivals.none"));
    return json(copied.message, 2);
  }

  /** Offer the types of a topic that has several: the gateway sends none of them before one is chosen. */
  #offerTypes() {
    const types = [...new Set([this.chosenType, ...(this.gateway.graph.topics.get(this.topic)?.types ?? [])])];
    const options = types.map((each) => new Option(each || say("topic.type.choose"), each, false, each === this.chosenType));
    this.#types.hidden = types.filter(Boolean).length < 2;
    const offered = [...this.#types.options].map(({ value }) => value);
    if (String(types) !== String(offered)) this.#types.replaceChildren(...options); // only then: a list that is open would close
  }

  #choose(chosenType) {
    this.#type = chosenType || this.gateway.graph.typeOf(this.topic);
    this.writeType(this.#type);
    this.#restart({ chosenType, view: misfit(this.view, this.#type) ? viewsFor(this.#type)[0] : this.view });
    this.#offer();
  }

  #sayNotCopied(problem) {
    this.untell(this.#notCopied);
    this.#notCopied = problem && say("topic.uncopied", { problem });
    if (problem) this.tell(this.#notCopied);
  }

  #restart(changed) {
    Object.assign(this, changed);
    this.#start();
    this.actions.changed();
  }

  #start() {
    this.#unsubscribe();
    this.#unsubscribe = () => {};
    this.#view?.close?.();
    this.#isDirty = this.#isBroken = false;
    this.#failure = "";
    this.#view = makeView(this.view, this);
    this.body.replaceChildren(this.#view.element);
    const problem = misfit(this.view, this.#type);
    this.tell(problem);
    if (!problem) this.subscribe();
  }

  /** Subscribe as the view asks for it now. */
  subscribe() {
    const { throttle_rate: least = 0, ...options } = this.#view.options;
    const throttle = Math.max(least, this.rate ? Math.round(1000 / this.rate) : 0);
    const endBefore = this.#unsubscribe;
    this.#unsubscribe = this.gateway.subscribe(
      this.topic,
      { ...options, ...(this.chosenType && { type: this.chosenType }), throttle_rate: throttle },
      (message, size, data, dropped) => this.#receive(message, size, data, dropped),
      (status) => this.#status(status),
    );
    endBefore(); // now: without a subscription the topic would begin again
  }

  #receive(message, size, data, dropped) {
    this.#arrivals.add(size, dropped);
    this.#receivedMs = performance.now();
    this.#newest = { message, data };
    this.#isDirty = true;
    this.#isBroken = false; // it was perhaps this one message
    const { code } = this.problem.dataset;
    if (PASSING.includes(code) && code !== GONE) this.#forgive(); // a node publishes now
    this.#attempt(() => this.#view.keep?.(message));
  }

  #recover() {
    this.untell(this.#failure);
    this.#failure = "";
  }

  #status({ msg, code = "" }) {
    this.tell(msg, code);
    this.#toldMs = performance.now();
  }

  /** Remove the words of the gateway. Other problems stay. */
  #forgive() {
    if (this.problem.dataset.code) this.tell("");
  }
}

/** Return the names of nodes in words: a few of them. */
function names(nodes) {
  const all = [...new Set(nodes)];
  const shown = all.slice(0, MOST_NAMES).join(", ");
  return all.length > MOST_NAMES ? say("topic.more", { names: shown, count: all.length - MOST_NAMES }) : shown;
}
