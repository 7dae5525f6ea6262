// SPDX-License-Identifier: Apache-2.0
import { element, span } from "../shared/dom.js";
import { TreeView } from "./tree.js";

const SPANS_S = [10, 30, 60, 120, 300, 600];
const USUAL_S = 30;
const MODES = { value: "values", change: "change per second", xy: "first against others" };
const TIMES = { arrival: "by arrival", stamp: "by stamp" };
const STEP_S = 0.1; // of the slider
const FREED_MS = 10_000; // by then a browser has read a file that it saves

/** The choices of a user in a plot: how long, what, by which time, and more curves. */
export class PlotTools {
  /** Goes back in a plot that stands still. */
  slider;
  #card;
  #span;
  #mode;
  #time;
  #others;
  #back;
  #choice = element("div", { className: "choice" });
  #end = () => {};

  /**
   * @param {any} card
   * @param {{changed: (name: string) => void, panned: () => void, csv: () => string, add: (field: string) => void}} plot
   */
  constructor(card, plot) {
    this.#card = card;
    this.#span = select(card, plot, "window", Object.fromEntries(SPANS_S.map((each) => [each, span(each * 1000).replace(".0", "")])), USUAL_S);
    this.#mode = select(card, plot, "mode", MODES, "value");
    this.#time = select(card, plot, "time", TIMES, "arrival");
    this.#others = element("select", { aria: { label: `add a topic to the plot of ${card.topic}` } }, new Option("add a topic", ""));
    this.#others.onfocus = () => this.#offer();
    this.#others.onchange = () => this.#choose(this.#others.value, plot);
    const save = element("button", { type: "button", title: "save all that is kept as a file", aria: { label: `CSV of ${card.topic}` } }, "CSV");
    save.onclick = () => download(`${card.topic.slice(1).replaceAll("/", "-")}.csv`, plot.csv());
    this.element = element("div", {}, element("div", { className: "tools" }, this.#span, this.#mode, this.#time, this.#others, save), this.#choice);
    this.#back = element("input", { type: "range", max: 0, step: STEP_S, value: 0, aria: { label: `seconds back in the plot of ${card.topic}` } });
    this.#back.oninput = () => plot.panned();
    this.slider = element("label", { className: "back", hidden: true }, "back ", this.#back);
  }

  /** Seconds that are seen. */
  get span() {
    return Number(this.#span.value);
  }

  get mode() {
    return this.#mode.value;
  }

  /** Whether time is that of the stamps, not of the arrival. */
  get isStamped() {
    return this.#time.value === "stamp";
  }

  /** How many seconds before the end of the plot the window ends. */
  get back() {
    return -Number(this.#back.value);
  }

  /** Offer to go back by so many seconds, or not. */
  hold(isPaused, most) {
    this.slider.hidden = !isPaused || this.mode === "xy";
    this.#back.min = String(-most);
    this.#back.value = "0";
  }

  close() {
    this.#end();
  }

  #offer() {
    const names = [...this.#card.gateway.graph.topics.values()].filter(({ publishers }) => publishers.length).map(({ name }) => name).sort();
    this.#others.replaceChildren(new Option("add a topic", ""), ...names.map((each) => new Option(each)));
  }

  /** Show the numbers of a topic, until one is chosen. */
  #choose(topic, plot) {
    this.#end();
    this.#choice.replaceChildren();
    if (!topic) return;
    const tree = new TreeView({ plot: (path) => {
      this.#end();
      this.#choice.replaceChildren();
      this.#others.value = "";
      plot.add(topic === this.#card.topic ? path : `${topic}:${path}`);
    } });
    this.#choice.append(`Which number of ${topic}? `, tree.element);
    const end = this.#card.gateway.subscribe(topic, tree.options, (message) => tree.show(message), ({ msg }) => this.#card.tell(msg));
    this.#end = () => {
      end();
      this.#end = () => {};
    };
  }
}

/** Return a choice that the card keeps. */
function select(card, plot, name, words, usual) {
  const made = element("select", { aria: { label: `${name} of ${card.topic}` } }, ...Object.entries(words).map(([value, text]) => new Option(text, value)));
  made.value = card.settings[name] in words ? card.settings[name] : String(usual);
  made.onchange = () => {
    card.keep(name, made.value, usual);
    plot.changed(name);
  };
  return made;
}

function download(name, text) {
  const href = URL.createObjectURL(new Blob([text], { type: "text/csv" }));
  element("a", { href, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(href), FREED_MS);
}
