// SPDX-License-Identifier: Apache-2.0
// The data that a plot keeps: for each topic the times of its messages, and the values of its curves.

const MOST_S = 600; // as long as the longest window
const MOST_POINTS = 60_000; // of a curve: 100 Hz for 10 min
const MOST_LATE_S = 5; // so much older than the newest a message of another node may be. An older one is of a new beginning
const INSTANT_S = 1e-6; // from the last value to the gap behind it
const SLACK = 0.1; // it may have so much more, so that not each message moves all of it

/** The newest values of some curves of one topic, in the order of their times. */
export class Samples {
  #columns = [[]]; // times in seconds, and the values of each curve. Null is a gap
  #breaks = new Set(); // times at which there is a gap, and no message

  /** @param {number} count of curves */
  constructor(count) {
    for (let index = 0; index < count; index += 1) this.addColumn();
  }

  /** How many there are. */
  get length() {
    return this.#columns[0].length;
  }

  /** The time of the first, in seconds. */
  get oldest() {
    return this.#columns[0][0];
  }

  /** The time of the last, in seconds. */
  get newest() {
    return this.#columns[0].at(-1);
  }

  /** Have one more curve, without values so far. */
  addColumn() {
    this.#columns.push(this.#columns[0].map(() => null));
  }

  /**
   * Take the values of a message, which may be a little late. If time goes back, as when a recording begins again, the earlier ones go.
   * Return whether it did.
   */
  add(time, values) {
    const hasBegunAgain = this.forgetAfter(time);
    const at = time < this.newest ? this.#at(time, true) : this.length;
    [time, ...values].forEach((value, index) => this.#columns[index].splice(at, 0, value));
    this.#trim();
    return hasBegunAgain;
  }

  /** Let no line lead from the newest values to the next. */
  breakOff() {
    if (!this.length || this.#breaks.has(this.newest)) return;
    const time = this.newest + INSTANT_S;
    this.#columns.forEach((each, index) => each.push(index ? null : time));
    this.#breaks.add(time);
  }

  /** Forget all of a time that has not come again yet. Return whether there was any. */
  forgetAfter(time) {
    if (!(time < this.newest - MOST_LATE_S)) return false;
    for (const each of this.#columns) each.length = 0;
    this.#breaks.clear();
    return true;
  }

  #trim() {
    const time = this.newest;
    const late = this.oldest < time - MOST_S * (1 + SLACK) ? this.#at(time - MOST_S) : 0;
    const excess = this.length > MOST_POINTS * (1 + SLACK) ? this.length - MOST_POINTS : 0;
    const gone = Math.max(late, excess);
    if (gone) for (const each of this.#columns) each.splice(0, gone);
    for (const each of this.#breaks) if (each < this.oldest) this.#breaks.delete(each);
  }

  /** Return times and values from one time to another, with the one before: its line leads into the window. */
  within(from, to) {
    const first = Math.max(0, this.#at(from) - 1);
    const end = this.newest <= to ? this.length : this.#at(to);
    return this.#columns.map((each) => each.slice(first, end));
  }

  /** Return a table of its times with the rows of messages alone. */
  withoutBreaks(table) {
    return table.map((each) => each.filter((_, at) => !this.#breaks.has(table[0][at])));
  }

  /** Return the place of the first that is at least as new, or newer. */
  #at(time, isNewer = false) {
    const [times] = this.#columns;
    let [low, high] = [0, times.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (times[middle] < time || (isNewer && times[middle] === time)) low = middle + 1;
      else high = middle;
    }
    return low;
  }
}

/** Return how fast values change, per second. */
export function changes(times, values) {
  return values.map((value, at) => {
    const before = values[at - 1] ?? null;
    const passed = times[at] - times[at - 1];
    return value === null || before === null || !(passed > 0) ? null : (Number(value) - Number(before)) / passed;
  });
}

/** Return the unit of how fast a value of a unit changes. */
export function unitOfChange(unit) {
  if (!unit) return "";
  return unit.endsWith("/s") ? `${unit}²` : `${unit}/s`;
}

/** Return pairs: each value with the newest value of the first column at its time. Null is a gap. */
export function pairs(table) {
  const [, xs, ...others] = table;
  return others.map((ys) => {
    const found = [[], []];
    let x = null;
    xs.forEach((each, at) => {
      if (each !== undefined) x = each;
      if (ys[at] === undefined) return;
      const isGap = x === null || ys[at] === null;
      found[0].push(isGap ? null : x);
      found[1].push(isGap ? null : ys[at]);
    });
    return found;
  });
}

/**
 * Return a table as CSV.
 * @param {string[]} names of the columns
 * @param {any[][]} columns
 */
export function csv(names, columns) {
  const cell = (value) => (value === null || value === undefined ? "" : String(value));
  const rows = columns[0].map((_, at) => columns.map((each) => cell(each[at])).join(","));
  return [names.map((each) => `"${each.replaceAll('"', '""')}"`).join(","), ...rows, ""].join("\r\n");
}
