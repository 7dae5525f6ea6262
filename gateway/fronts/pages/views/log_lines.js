// SPDX-License-Identifier: Apache-2.0

const MOST = 5000; // lines

/**
 * A `rcl_interfaces/msg/Log` with its number.
 * @typedef {{at: number, level: number, stamp: {sec: number, nanosec: number}, name: string, msg: string, file: string, function: string, line: number}} Line
 */

/** The newest lines of a log, and those of them that a filter lets through. */
export class LogLines {
  /** @type {Line[]} */ shown = [];
  /** The names of the nodes so far. @type {Set<string>} */
  nodes = new Set();
  /** Of all lines. */
  counts = { lines: 0, errors: 0, warnings: 0 };
  /** @type {Line[]} */ #lines = [];
  #waiting = []; // messages that came since lines were taken, as while the card is paused
  #next = 0;
  #fits;
  #known = new Set(); // keys of lines from before: of a few seconds, they come again

  /** @param {{least: number, node: string, text: string}} filter */
  constructor(filter) {
    this.#fits = fitting(filter);
  }

  /** The number of the first line. */
  get first() {
    return this.#lines[0]?.at ?? 0;
  }

  /** Note a message, until `take` makes it a line. */
  add(message) {
    this.#waiting.push(message);
    if (this.#waiting.length > MOST + MOST / 10) this.#waiting.splice(0, this.#waiting.length - MOST);
  }

  /**
   * Make lines of all messages that wait. Return how many of the shown lines are gone for it.
   * @param {any[]} earlier messages from before
   */
  take(earlier) {
    if (earlier.length) this.#takeEarlier(earlier);
    const taken = this.#waiting.filter((each) => !this.#known.delete(keyOf(each))).map((each) => this.#made(each));
    this.#waiting = [];
    this.#lines.push(...taken);
    this.shown.push(...taken.filter(this.#fits));
    return this.#trim();
  }

  filter(filter) {
    this.#fits = fitting(filter);
    this.shown = this.#lines.filter(this.#fits);
  }

  #takeEarlier(messages) {
    const live = new Set(this.#lines.map(keyOf));
    const before = messages.filter((each) => !live.has(keyOf(each)));
    this.#known = new Set(before.map(keyOf));
    this.#lines = [...before.map((each) => this.#made(each)), ...this.#lines];
    this.shown = this.#lines.filter(this.#fits);
  }

  #made(message) {
    this.#count(message, 1);
    if (this.nodes.size < MOST) this.nodes.add(message.name);
    return { ...message, at: this.#next++ };
  }

  #trim() {
    const excess = this.#lines.splice(0, Math.max(0, this.#lines.length - MOST));
    for (const each of excess) this.#count(each, -1);
    const gone = excess.filter(this.#fits).length;
    this.shown.splice(0, gone);
    return gone;
  }

  #count({ level }, by) {
    this.counts.lines += by;
    if (level >= 40) this.counts.errors += by;
    else if (level >= 30) this.counts.warnings += by;
  }
}

const keyOf = ({ stamp: { sec, nanosec }, name, msg }) => `${sec}.${nanosec} ${name} ${msg}`;

/** Return a function that says whether a line is shown. */
function fitting({ least, node, text }) {
  const wanted = text.toLowerCase();
  return ({ level, name, msg }) => level >= least && (!node || name === node) && (!wanted || msg.toLowerCase().includes(wanted) || name.toLowerCase().includes(wanted));
}
