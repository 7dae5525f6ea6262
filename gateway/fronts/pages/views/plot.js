// SPDX-License-Identifier: Apache-2.0
import { element, token } from "../shared/dom.js";
import uPlot from "../vendor/uplot.js";
import { isNumber } from "./numbers.js";
import { TreeView } from "./tree.js";

const SPAN_S = 30;
const MOST_POINTS = 6000;
const HEIGHT = 220; // pixels, as these are:
const LINE = 1.5;
const EDGE = 1;
const LEAST_SHARE = 1e-9; // of a number, that an axis shows around it
const LARGEST = 8e307; // on an axis: the difference of its ends is also a number
const STEPS_S = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 30, 60]; // between two marks of time
/** @type {any} the library has no types here */
const Plot = uPlot;
const COLOURS = ["series-1", "series-2", "series-3", "series-4"];

/** Numeric fields over the last 30 s, by the time of arrival, with their values at the pointer. */
export class PlotView {
  /** What to do with a plot that stands still, in words. */
  held = "drag across the plot to zoom, double-click to see all";
  /** Milliseconds between two drawings: the eye sees no more of a line. */
  rest = 66;
  element = element("div", { className: "plot" });
  #columns; // time, and the values of each field
  #drawn; // of these what is drawn: it stands still while more is kept
  #drawnAt = 0; // in seconds
  #hasLong = false; // whether a value is a BigInt, which nothing can be drawn by
  #plot = null;
  /** @type {TreeView|null} of the numbers that can be plotted, until one is chosen */
  #choice = null;
  #labels = []; // of the legend, one for each curve
  /** In pixels. To ask the element would lay out the page for each plot, because the one before has written its legend. */
  #width = 0;
  #observer = new ResizeObserver((entries) => (this.#width = Math.floor(entries.at(-1).contentRect.width)));

  constructor(card) {
    this.card = card;
    this.#observer.observe(this.element);
    if (!card.fields.length) this.#choice = new TreeView({ plot: (path) => card.choose(path) });
    this.#columns = [[], ...card.fields.map(() => [])];
    this.#drawn = this.#columns.map(() => []);
  }

  get options() {
    return this.#choice?.options ?? { fields: this.card.fields.map((each) => each.replace(/\.\d+(?=\.|$).*/, "")) };
  }

  /** Draw one more field of the card: the newest of its fields. The drawn ones continue. */
  add() {
    for (const columns of [this.#columns, this.#drawn]) columns.push(columns[0].map(() => null));
    this.#plot?.destroy();
    this.#plot = null;
    this.#labels = [];
    if (this.#drawn[0].length) this.#render();
  }

  keep(message) {
    if (this.#choice) return;
    const now = performance.now() / 1000;
    let strange = "";
    this.#columns[0].push(now);
    this.card.fields.forEach((path, index) => {
      const value = path.split(".").reduce((each, name) => each?.[name], message);
      strange ||= value === undefined || typeof value === "boolean" || isNumber(value) ? "" : path;
      this.#hasLong ||= typeof value === "bigint";
      this.#columns[index + 1].push(drawable(value));
    });
    const late = this.#columns[0].findIndex((each) => each >= now - SPAN_S);
    const excess = Math.max(late, this.#columns[0].length - MOST_POINTS);
    if (excess > MOST_POINTS / 10 || late > 200) for (const each of this.#columns) each.splice(0, excess);
    if (strange) throw new TypeError(`${strange} is not a number`);
  }

  show(message) {
    if (this.#choice) {
      if (!this.#choice.element.isConnected) this.element.append("Which number? ", this.#choice.element);
      this.#choice.show(message);
      return;
    }
    this.#drawn = this.#columns.map((each) => each.slice());
    this.#drawnAt = performance.now() / 1000;
    this.#render();
  }

  draw() {
    if (!this.#plot && this.#drawn[0].length) this.#render(); // it was not laid out when its newest message came
  }

  #render() {
    if (!this.#width) return; // not laid out yet
    this.#plot ??= this.#make(this.#width);
    if (this.#plot.width !== this.#width) this.#plot.setSize({ width: this.#width, height: HEIGHT });
    this.#plot.setData(this.#numbers, false);
    this.#plot.setScale("x", { min: this.#drawnAt - SPAN_S, max: this.#drawnAt });
    this.#label();
  }

  /** The drawn values as numbers: a curve does not need the last digits of a long integer. */
  get #numbers() {
    return this.#hasLong ? this.#drawn.map((each) => each.map((value) => (value === null ? null : Number(value)))) : this.#drawn;
  }

  close() {
    this.#observer.disconnect();
  }

  /** Write the value of each curve next to its name: the one at the pointer, or else the newest. */
  #label() {
    if (!this.#labels.length) this.#labels = [...this.element.querySelectorAll(".u-series .u-label")].slice(-this.card.fields.length);
    const place = this.#plot?.cursor.idx ?? -1;
    const time = place < 0 ? "" : `, ${(-this.#since(this.#drawn[0][place])).toFixed(1)} s ago`;
    this.card.fields.forEach((path, index) => {
      const text = `${path} ${written(this.#drawn[index + 1].at(place))}${time}`;
      if (this.#labels[index].textContent !== text) this.#labels[index].textContent = text;
    });
  }

  /** Return a time in seconds since the newest values came. */
  #since(time) {
    return time - this.#drawn[0].at(-1);
  }

  #make(width) {
    // a plot that goes on has the last 30 s, whatever is chosen
    const whilePaused = (_plot, _target, handler) => (event) => this.card.isPaused && handler(event);
    const axis = { stroke: token("quiet"), grid: { stroke: token("line"), width: 1 }, ticks: { stroke: token("line"), width: 1 } };
    const time = {
      incrs: STEPS_S,
      splits: (_plot, _axis, least, most, step) => this.#marks(least, most, step),
      values: (_plot, marks, _axis, _room, step) => marks.map((each) => `${inSeconds(this.#since(each), step < 0.1 ? 2 : step < 1 ? 1 : 0)} s`),
    };
    const series = this.card.fields.map((label, index, { length }) => ({
      label,
      stroke: token(COLOURS[index % COLOURS.length]),
      width: LINE + (length - 1 - index) * EDGE, // of two that are equal, the one behind shows as an edge
      spanGaps: false,
      points: { show: false, filter: aloneIn },
    }));
    return new Plot({
      width,
      height: HEIGHT,
      cursor: { y: false, drag: { x: true, y: false }, bind: { mousedown: whilePaused, dblclick: whilePaused } },
      hooks: { setCursor: [() => this.#label()] },
      scales: { x: { time: false }, y: { range: (_, least, most) => around(least, most) } },
      axes: [{ ...axis, ...time }, { ...axis, size: 60 }],
      series: [{}, ...series],
      legend: { live: false },
    }, this.#numbers, this.element);
  }

  /** Return round times since the newest values, as places on the axis. */
  #marks(least, most, step) {
    const newest = this.#drawn[0].at(-1) ?? most;
    const first = Math.ceil((least - newest) / step);
    const count = Math.floor((most - newest) / step) - first + 1;
    return Array.from({ length: count }, (_, index) => newest + (first + index) * step);
  }
}

/** Return a value as a curve has it. Null is a gap. */
function drawable(value) {
  if (typeof value === "boolean") return Number(value);
  return typeof value === "bigint" || Number.isFinite(value) ? value : null;
}

/** Return seconds as text. None is 0, a little before and after. */
function inSeconds(value, digits) {
  const text = value.toFixed(digits);
  return Number(text) === 0 ? "0" : text;
}

/** Return a value for the place next to a name: short, and as wide as the one before. */
function written(value) {
  if (value === null || value === undefined) return "–";
  return typeof value === "bigint" || Number.isInteger(value) ? String(value) : Math.abs(value) < 1e-3 || Math.abs(value) >= 1e6 ? value.toExponential(2) : value.toFixed(3);
}

/**
 * Return the range of the axis: a tenth more than the values. If they are all the same, or too close for marks between them, it
 * is wider.
 */
function around(least, most) {
  if (least === null) return [-1, 1];
  const size = Math.max(Math.abs(least), Math.abs(most));
  const margin = least === most ? size || 1 : Math.max((most - least) / 10, size * LEAST_SHARE);
  return [Math.max(least - margin, -LARGEST), Math.min(most + margin, LARGEST)];
}

/** Return where a curve has values without a neighbour, which no line shows, or null. */
function aloneIn(plot, index) {
  const values = plot.data[index];
  const found = [];
  values.forEach((value, at) => {
    if (value !== null && (values[at - 1] ?? null) === null && (values[at + 1] ?? null) === null) found.push(at);
  });
  return found.length ? found : null;
}
