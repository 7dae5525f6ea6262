// SPDX-License-Identifier: Apache-2.0
import { element, span } from "../shared/dom.js";
import { say } from "../shared/language.js";
import { TreeView } from "./tree.js";

const SPANS_S = [10, 30, 60, 120, 300, 600];
const USUAL_S = 30;
const MODES = ["value", "change", "xy"];
const TIMES = ["arrival", "stamp"];
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
    this.#span = select(card, plot, "window", SPANS_S.map((each) => new Option(span(each * 1000).replace(".0", ""), String(each))), USUAL_S);
    this.#mode = select(card, plot, "mode", MODES.map((each) => new Option(say(`plot.mode.${each}`), each)), "value");
    this.#time = select(card, plot, "time", TIMES.map((each) => new Option(say(`plot.time.${each}`), each)), "arrival");
    this.#others = element("select", { aria: { label: say("plot.add.to", { topic: card.topic }) } }, new Option(say("plot.add"), ""));
    this.#others.onfocus = () => this.#offer();
    this.#others.onchange = () => this.#choose(this.#others.value, plot);
    const save = element("button", { type: "button", title: say("plot.csv.about"), aria: { label: say("plot.csv.of", { topic: card.topic }) } }, "CSV");
    save.onclick = () => download(`${card.topic.slice(1).replaceAll("/", "-")}.csv`, plot.csv());
    this.element = element("div", {}, element("div", { className: "tools" }, this.#span, this.#mode, this.#time, this.#others, save), this.#choice);
    this.#back = element("input", { type: "range", max: 0, step: STEP_S, value: 0, aria: { label: say("plot.back.of", { topic: card.topic }) } });
    this.#back.oninput = () => plot.panned();
    this.slider = element("label", { className: "back", hidden: true }, `${say("plot.back")} `, this.#back);
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
    this.#others.replaceChildren(new Option(say("plot.add"), ""), ...names.map((each) => new Option(each)));
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
    this.#choice.append(`${say("choose.number.of", { topic })} `, tree.element);
    const end = this.#card.gateway.subscribe(topic, tree.options, (message) => tree.show(message), ({ msg }) => this.#card.tell(msg));
    this.#end = () => {
      end();
      this.#end = () => {};
    };
  }
}

/** Return a choice that the card keeps. */
function select(card, plot, name, options, usual) {
  const made = element("select", { aria: { label: say(`plot.${name}.of`, { topic: card.topic }) } }, ...options);
  made.value = options.some(({ value }) => value === card.settings[name]) ? card.settings[name] : String(usual);
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
