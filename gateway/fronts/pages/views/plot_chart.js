// SPDX-License-Identifier: Apache-2.0
// The drawing of a plot, by uPlot: curves over time, or one number against another.

import { token } from "../shared/dom.js";
import { say } from "../shared/language.js";
import uPlot from "../vendor/uplot.js";

const LINE = 1.5; // pixels
const EDGE = 1;
const LEAST_SHARE = 1e-9; // of a number, that an axis shows around it
const LARGEST = 8e307; // on an axis: the difference of its ends is also a number
const STEPS_S = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 30, 60, 120]; // between two marks of time
const COLOURS = ["series-1", "series-2", "series-3", "series-4"];
const DASH = [6, 4]; // of the curves that have a colour for the second time
/** @type {any} the library has no types here */
const Plot = uPlot;

/** Join tables of times and values, each with other times. At a time of another table a value is undefined, which makes no gap. */
export const join = (tables) => (tables.length === 1 ? tables[0] : Plot.join(tables, tables.map((each) => each.map(() => 1))));

/**
 * The questions of a chart to its view.
 * `size` and `legend` are the room that it has: its legend lies elsewhere, as it is as high as its words need.
 * @typedef {{size: {width: number, height: number}, legend: HTMLElement, isPaused: () => boolean, moved: () => void, since: (time: number) => number, toggled: (index: number, isShown: boolean) => void}} Owner
 */

/**
 * Make a chart of curves over time.
 * @param {{label: string, isShown: boolean}[]} curves
 * @param {Owner} owner
 */
export function overTime(curves, owner, data, place) {
  const time = {
    incrs: STEPS_S,
    splits: (_plot, _axis, least, most, step) => marks(data(), least, most, step),
    values: (_plot, places, _axis, _room, step) => places.map((each) => `${inSeconds(owner.since(each), step < 0.1 ? 2 : step < 1 ? 1 : 0)} s`),
  };
  // a plot that goes on has its newest values, whatever is chosen
  const whilePaused = (_plot, _target, handler) => (event) => owner.isPaused() && handler(event);
  const series = curves.map((each, index) => ({ ...lookOf(each, index, curves.length), spanGaps: false, points: { show: false, filter: aloneIn } }));
  return made({
    ...common(owner),
    cursor: { y: false, drag: { x: true, y: false }, bind: { mousedown: whilePaused, dblclick: whilePaused } },
    scales: { x: { time: false }, y: { range: (_, least, most) => around(least, most) } },
    axes: [{ ...axis(), ...time }, { ...axis(), size: 60 }],
    series: [{}, ...series],
  }, data(), place, owner, 0);
}

/** Make a chart of curves against the first one. @param {{label: string, isShown: boolean}[]} all */
export function against(all, owner, data, place) {
  const [first, ...curves] = all;
  const facets = [{ scale: "x", auto: true }, { scale: "y", auto: true }];
  const series = curves.map((each, index) => ({ ...lookOf(each, index, curves.length), facets, paths: line, points: { show: false } }));
  const range = (_, least, most) => around(least, most);
  return made({
    ...common(owner),
    mode: 2,
    cursor: { show: false },
    scales: { x: { time: false, range }, y: { range } },
    axes: [{ ...axis(), label: first.label, labelSize: 20 }, { ...axis(), size: 60 }],
    series: [null, ...series],
  }, data(), place, owner, 1);
}

/** @param {number} skipped curves that have no series */
function made(options, data, place, owner, skipped) {
  const plot = new Plot(options, data, place);
  const labels = [...owner.legend.querySelectorAll(".u-series .u-label")].slice(-(options.series.length - 1));
  labels.forEach((label, index) => {
    label.tabIndex = 0;
    label.setAttribute("role", "button");
    label.title = say("plot.curve");
    label.onkeydown = (event) => {
      if (event.key !== "Enter" && event.key !== " ") return;
      event.preventDefault();
      label.click();
    };
    press(label, plot.series[index + 1].show);
  });
  plot.hooks.setSeries = [(_plot, index, { show }) => {
    if (index === null || show === undefined) return;
    press(labels[index - 1], show);
    owner.toggled(index - 1 + skipped, show);
  }];
  return Object.assign(plot, { labels });
}

const press = (label, isShown) => label.setAttribute("aria-pressed", String(isShown));

const common = (owner) => ({
  ...owner.size,
  hooks: { setCursor: [() => owner.moved()] },
  legend: {
    live: false,
    mount: (_plot, table) => owner.legend.replaceChildren(table),
    markers: { stroke: (_plot, index) => `var(--${COLOURS[(index - 1) % COLOURS.length]})` },
  },
});

const axis = () => ({ stroke: () => token("quiet"), grid: { stroke: () => token("line"), width: 1 }, ticks: { stroke: () => token("line"), width: 1 } });

const lookOf = ({ label, isShown }, index, count) => ({
  label,
  show: isShown,
  stroke: () => token(COLOURS[index % COLOURS.length]),
  dash: index < COLOURS.length ? undefined : DASH,
  width: LINE + (Math.min(count, COLOURS.length) - 1 - (index % COLOURS.length)) * EDGE, // of two that are equal, the one behind shows as an edge
});

/** Draw one number against another. */
function line(plot, index) {
  Plot.orient(plot, index, (series, xs, ys, scaleX, scaleY, toX, toY, left, top, wide, high) => {
    const path = new Path2D();
    const [xData, yData] = plot.data[index];
    xData.forEach((x, at) => {
      if (x !== null) path[(xData[at - 1] ?? null) === null ? "moveTo" : "lineTo"](toX(x, scaleX, wide, left), toY(yData[at], scaleY, high, top));
    });
    plot.ctx.save();
    plot.ctx.strokeStyle = typeof series.stroke === "function" ? series.stroke(plot, index) : series.stroke;
    plot.ctx.lineWidth = LINE * devicePixelRatio;
    plot.ctx.stroke(path);
    plot.ctx.restore();
  });
  return null;
}

/** Return round times since the newest values, as places on the axis. */
function marks(data, least, most, step) {
  const newest = data[0].at(-1) ?? most;
  const first = Math.ceil((least - newest) / step);
  const count = Math.floor((most - newest) / step) - first + 1;
  return Array.from({ length: count }, (_, index) => newest + (first + index) * step);
}

/** Return seconds as text. None is 0, a little before and after. */
function inSeconds(value, digits) {
  const text = value.toFixed(digits);
  return Number(text) === 0 ? "0" : text;
}

/**
 * Return the range of the axis: a tenth more than the values. If they are all the same, or too close for marks between them, it
 * is wider.
 */
function around(least, most) {
  if (!Number.isFinite(least) || !Number.isFinite(most)) return [-1, 1];
  const size = Math.max(Math.abs(least), Math.abs(most));
  const margin = least === most ? size || 1 : Math.max((most - least) / 10, size * LEAST_SHARE);
  return [Math.max(least - margin, -LARGEST), Math.min(most + margin, LARGEST)];
}

/** Return where a curve has values without a neighbour, which no line shows, or null. */
function aloneIn(plot, index) {
  const values = plot.data[index];
  const found = [];
  values.forEach((value, at) => {
    if ((value ?? null) !== null && isEnd(values, at - 1) && isEnd(values, at + 1)) found.push(at);
  });
  return found.length ? found : null;
}

/** Whether there is a gap at a place, or nothing. */
const isEnd = (values, at) => at < 0 || at >= values.length || values[at] === null;
