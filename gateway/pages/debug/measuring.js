// SPDX-License-Identifier: Apache-2.0

import { NOTHING_YET } from "../shared/arrivals.js";

const EVERY_MS = 500;

/**
 * Rate, size and age of topics: of those that a card shows by what comes for it, of others that can be seen in the list, on request,
 * by two frames a second that say nothing but that samples come.
 */
export class Measuring {
  #gateway;
  #isOn = false;
  #seen = new Set(); // topics
  #measured = new Map(); // topic -> what ends it, and what the gateway says against it

  /** @param {import("../shared/gateway.js").Gateway} gateway */
  constructor(gateway) {
    this.#gateway = gateway;
  }

  /** Whether the topics that are seen are measured. */
  get isOn() {
    return this.#isOn;
  }

  set isOn(isOn) {
    this.#isOn = isOn;
    this.tick();
  }

  /** Note whether a topic can be seen. */
  see(topic, isSeen) {
    if (isSeen) this.#seen.add(topic);
    else this.#seen.delete(topic);
  }

  /** Return what has come of a topic, if that is known. */
  arrivals(topic) {
    return this.#gateway.arrivals.get(topic) ?? this.#gateway.arrivals.get(byOtherName(topic));
  }

  /** Return what is known of a topic in words: its figures, or why there are none. */
  words(topic) {
    const measured = this.#measured.get(topic);
    return measured?.problem || (this.arrivals(topic)?.words ?? (measured ? NOTHING_YET : ""));
  }

  /** Measure what is to be measured now; called once a second, so that scrolling by asks for nothing. */
  tick() {
    const { topics } = this.#gateway.graph;
    const isWanted = (topic) => this.#isOn && this.#seen.has(topic) && Boolean(topics.get(topic)?.publishers.length);
    for (const [topic, { end }] of this.#measured) {
      if (isWanted(topic)) continue;
      end();
      this.#measured.delete(topic);
    }
    for (const topic of this.#seen) if (isWanted(topic) && !this.#measured.has(topic)) this.#measure(topic);
  }

  #measure(topic) {
    const measured = { end: () => {}, problem: "" };
    this.#measured.set(topic, measured);
    measured.end = this.#gateway.subscribe(
      byOtherName(topic),
      { fields: [], throttle_rate: EVERY_MS },
      () => {},
      ({ level, msg }) => { measured.problem = level === "error" ? msg : ""; },
    );
  }
}

/** Name a topic such that its frames come apart from those of the cards, which have the usual name. */
const byOtherName = (topic) => topic.slice(1);
