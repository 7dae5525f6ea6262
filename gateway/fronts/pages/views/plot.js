// SPDX-License-Identifier: Apache-2.0
import { element } from "../shared/dom.js";
import { say } from "../shared/language.js";
import { asked, isNumber, valueAt, written } from "./numbers.js";
import { against, join, overTime } from "./plot_chart.js";
import { changes, csv, pairs, Samples, unitOfChange } from "./plot_data.js";
import { PlotTools } from "./plot_tools.js";
import { TreeView } from "./tree.js";
import { unitOf } from "./units.js";

const LEAST_REST_MS = 66; // the eye sees no more of a line
const MOST_REST_MS = 500;
const MOST_CURVES = 8;
const STAMP = "header.stamp";

/**
 * A number that is plotted.
 * @typedef {{field: string, topic: string, path: string, isShown: boolean}} Curve
 * `field` is how the card names it: a path in its own topic, or `/topic:path`
 */

/** Numeric fields of one topic or several over some time, how fast they change, or one against another, with their values at the pointer. */
export class PlotView {
  static title = say("view.plot");

  /** What to do with a plot that stands still, in words. */
  held = say("plot.held");
  element = element("div", { className: "plot" });
  #card;
  /** @type {Curve[]} those of a topic next to each other */
  #curves = [];
  /** @type {Map<string, Samples>} of each topic */
  #samples = new Map();
  #ends = new Map(); // other topic -> what ends its subscription
  #drawn = [[]]; // it stands still while more is kept
  #drawnAt = 0; // the end of the window, in seconds
  #hasLong = false; // whether a value is a BigInt, which nothing can be drawn by
  #plot = null;
  #hasMore = false; // of other topics than that of the card
  #shownMs = 0; // when it was drawn up to the newest
  #wrong = ""; // the words about a message of another topic
  /** @type {TreeView|null} of the numbers that can be plotted, until one is chosen */
  #choice = null;
  #tools;
  #chart = element("div", { className: "chart" });
  #legend = element("div");
  /** Of the chart, in pixels. To ask the element would lay out the page for each plot, because the one before has written its legend. */
  #size = { width: 0, height: 0 };
  #observer = new ResizeObserver((entries) => {
    const { width, height } = entries.at(-1).contentRect;
    this.#size = { width: Math.floor(width), height: Math.floor(height) };
    if (this.#plot && this.#card.isPaused && width) this.#plot.setSize(this.#size);
  });

  constructor(card) {
    this.#card = card;
    this.#observer.observe(this.#chart);
    if (!card.fields.length) {
      this.#choice = new TreeView({ plot: (path) => card.choose(path) });
      return;
    }
    this.#tools = new PlotTools(card, { changed: (name) => this.#restart(name), panned: () => this.#pan(), csv: () => this.#csv(), add: (field) => this.#join(field) });
    this.element.append(this.#tools.element, this.#chart, this.#legend, this.#tools.slider);
    for (const each of card.fields.slice(0, MOST_CURVES)) this.#take(each);
    this.#follow();
  }

  get options() {
    if (this.#choice) return this.#choice.options;
    return { fields: this.#fieldsOf(this.#card.topic) };
  }

  /** Milliseconds between two drawings: of a long window, a curve moves slowly. */
  get rest() {
    return Math.max(LEAST_REST_MS, Math.min(MOST_REST_MS, 2 * (this.#tools?.span ?? 0)));
  }

  /** Draw one more field of the card: the newest of its fields. The drawn ones continue. */
  add() {
    if (this.#curves.length >= MOST_CURVES) return;
    this.#take(this.#card.fields.at(-1));
    this.#follow();
    this.#remake();
  }

  keep(message) {
    if (!this.#choice) this.#keep(this.#card.topic, message);
  }

  show(message = null) {
    if (this.#choice) {
      if (!this.#choice.element.isConnected) this.element.append(say("choose.number"), " ", this.#choice.element);
      this.#choice.show(message);
      return;
    }
    this.#drawnAt = this.#now;
    this.#shownMs = performance.now();
    this.#hasMore = false;
    this.#render();
  }

  draw() {
    if (this.#hasMore && performance.now() - this.#shownMs >= this.rest) this.show(); // the topic of the card may be a slow one
    const isDue = this.#plot ? !this.#fits : this.#hasSome;
    if (isDue) this.#render(); // it was not laid out when its newest message came, or it has another size since
  }

  /** Stand still, or go on. */
  hold(isPaused) {
    this.#tools?.hold(isPaused, Math.max(0, this.#drawnAt - this.#oldest - this.#tools.span));
    if (isPaused && this.#plot) this.#render();
  }

  /** Draw the same in the colours of the page. */
  recolour() {
    this.#plot?.redraw(false);
  }

  /** Nobody knows the values of the time in which the card was not seen. */
  wake() {
    for (const each of this.#samples.values()) each.breakOff();
  }

  close() {
    this.#observer.disconnect();
    this.#tools?.close();
    for (const end of this.#ends.values()) end();
  }

  get #hasSome() {
    return [...this.#samples.values()].some(({ length }) => length);
  }

  /** The time at which the window ends that is seen: now, or the newest stamp. */
  get #now() {
    if (!this.#tools.isStamped) return performance.now() / 1000;
    return Math.max(...[...this.#samples.values()].map(({ newest = 0 }) => newest));
  }

  get #oldest() {
    return Math.min(...[...this.#samples.values()].map(({ oldest = Infinity }) => oldest), this.#drawnAt);
  }

  /** Have one more curve, next to those of its topic. */
  #take(field) {
    const [topic, path] = field.startsWith("/") ? field.split(":") : [this.#card.topic, field];
    const curve = { field, topic, path, isShown: true };
    const last = this.#curves.map((each) => each.topic).lastIndexOf(topic);
    this.#curves.splice(last < 0 ? this.#curves.length : last + 1, 0, curve);
    if (!this.#samples.has(topic)) this.#samples.set(topic, new Samples(0));
    this.#samples.get(topic).addColumn();
  }

  #join(field) {
    if (!this.#card.fields.includes(field) && this.#curves.length < MOST_CURVES) this.#card.join(field);
  }

  #fieldsOf(topic) {
    const paths = this.#curves.filter((each) => each.topic === topic).map(({ path }) => asked(path));
    return this.#tools.isStamped ? [...paths, STAMP] : paths;
  }

  /** Subscribe to the other topics as their curves ask for it now. */
  #follow() {
    for (const topic of this.#samples.keys()) {
      if (topic === this.#card.topic) continue;
      const before = this.#ends.get(topic);
      const throttle = this.#card.rate ? Math.round(1000 / this.#card.rate) : 0;
      const options = { fields: this.#fieldsOf(topic), throttle_rate: throttle };
      this.#ends.set(topic, this.#card.gateway.subscribe(topic, options, (message) => this.#keepOther(topic, message), ({ msg }) => this.#card.tell(msg)));
      before?.();
    }
  }

  #keep(topic, message) {
    let strange = "";
    const values = this.#curves.filter((each) => each.topic === topic).map(({ path }) => {
      const value = valueAt(message, path);
      strange ||= value === undefined || typeof value === "boolean" || isNumber(value) ? "" : path;
      this.#hasLong ||= typeof value === "bigint";
      return drawable(value);
    });
    const { sec = 0, nanosec = 0 } = message.header?.stamp ?? {};
    const time = this.#tools.isStamped ? sec + nanosec / 1e9 : performance.now() / 1000;
    const hasBegunAgain = this.#samples.get(topic).add(time, values);
    if (hasBegunAgain) for (const each of this.#samples.values()) each.forgetAfter(time); // or the window would wait at their end
    if (strange) throw new TypeError(say("number.none", { path: strange }));
  }

  #keepOther(topic, message) {
    try {
      this.#keep(topic, message);
      if (this.#wrong) this.#card.untell(this.#wrong);
      this.#wrong = "";
    } catch (error) {
      this.#wrong = `${topic}: ${error.message}`;
      this.#card.tell(this.#wrong);
    }
    this.#hasMore = true;
  }

  #render() {
    if (!this.#size.width) return; // not laid out yet
    this.#draw();
  }

  #draw(end = this.#drawnAt) {
    this.#drawn = this.#table(end - this.#tools.span, end);
    const isMade = this.#plot !== null;
    this.#plot ??= (this.#tools.mode === "xy" ? against : overTime)(this.#labelled, this.#owner, () => this.#data, this.#chart);
    if (!this.#fits) this.#plot.setSize(this.#size);
    if (isMade) this.#plot.setData(this.#data, this.#tools.mode === "xy");
    if (this.#tools.mode !== "xy") this.#plot.setScale("x", { min: end - this.#tools.span, max: end });
    this.#label();
  }

  /** Return what is kept of a time, as a table of all curves. */
  #table(from, to, hasBreaks = true) {
    const tables = [...this.#samples.values()].map((each) => {
      const [times, ...columns] = each.within(from, to);
      const table = [times, ...(this.#tools.mode === "change" ? columns.map((values) => changes(times, values)) : columns)];
      return hasBreaks ? table : each.withoutBreaks(table);
    });
    return join(tables);
  }

  /** The drawn values as the chart takes them: a curve does not need the last digits of a long integer. */
  get #data() {
    const numbers = this.#hasLong ? this.#drawn.map((each) => each.map((value) => (typeof value === "bigint" ? Number(value) : value))) : this.#drawn;
    return this.#tools.mode === "xy" ? [null, ...pairs(numbers)] : numbers;
  }

  /** Whether it is drawn as large as its place. */
  get #fits() {
    return this.#plot.width === this.#size.width && this.#plot.height === this.#size.height;
  }

  get #labelled() {
    return this.#curves.map(({ field, isShown }) => ({ label: field, isShown }));
  }

  get #owner() {
    return {
      size: this.#size,
      legend: this.#legend,
      isPaused: () => this.#card.isPaused,
      moved: () => this.#plot && this.#label(),
      since: (time) => this.#since(time),
      toggled: (index, isShown) => (this.#curves[index].isShown = isShown),
    };
  }

  /** Write the value of each curve next to its name: the one at the pointer, or else the newest. */
  #label() {
    const place = this.#tools.mode === "xy" ? -1 : this.#plot.cursor.idx ?? -1;
    const time = place < 0 ? "" : `, ${say("plot.ago", { seconds: (-this.#since(this.#drawn[0][place])).toFixed(1) })}`;
    const skipped = this.#tools.mode === "xy" ? 1 : 0; // the one on the axis
    this.#curves.slice(skipped).forEach(({ field, topic, path }, index) => {
      const isChange = this.#tools.mode === "change";
      const unit = unitOf(this.#typeOf(topic), path);
      const value = `${written(this.#valueOf(index + skipped, place))} ${isChange ? unitOfChange(unit) : unit}`.trim();
      const text = `${field} ${value}${time}`;
      const label = this.#plot.labels[index];
      if (label && label.textContent !== text) label.textContent = text;
    });
  }

  #typeOf(topic) {
    return topic === this.#card.topic ? this.#card.type : this.#card.gateway.graph.typeOf(topic);
  }

  /** Return the value of a curve at a place, or its newest one, with every digit. */
  #valueOf(index, place) {
    const column = this.#drawn[index + 1];
    return place >= 0 ? column[place] : column.filter((each) => each !== undefined).at(-1);
  }

  /** Return a time in seconds since the newest values came. */
  #since(time) {
    return time - this.#drawn[0].at(-1);
  }

  #pan() {
    if (this.#plot) this.#draw(this.#drawnAt - this.#tools.back);
  }

  /** Begin again with another setting. With another kind of time, what is kept is of no use. */
  #restart(name) {
    if (name === "time") {
      for (const [topic] of this.#samples) this.#samples.set(topic, new Samples(this.#curves.filter((each) => each.topic === topic).length));
      this.#follow();
      this.#card.subscribe();
    }
    this.#remake();
    this.hold(this.#card.isPaused);
  }

  #remake() {
    this.#plot?.destroy();
    this.#plot = null;
    if (this.#hasSome) this.#render();
  }

  /** Return all that is kept, as CSV. */
  #csv() {
    const [times, ...columns] = this.#table(-Infinity, Infinity, false);
    const zero = this.#tools.isStamped ? 0 : performance.timeOrigin / 1000;
    return csv(["time (s)", ...this.#curves.map(({ field }) => field)], [times.map((each) => (each + zero).toFixed(6)), ...columns]);
  }
}

/** Return a value as a curve has it. Null is a gap. */
function drawable(value) {
  if (typeof value === "boolean") return Number(value);
  return typeof value === "bigint" || Number.isFinite(value) ? value : null;
}
