// SPDX-License-Identifier: Apache-2.0

import { say } from "../shared/language.js";
import { wordsOf } from "./arrival_words.js";

const EVERY_MS = 500;
const RETRY_TICKS = 10; // of one that is refused: there may be room again

/**
 * Rate, size and age of topics. A topic of a card is measured by the messages of its card. The others in the list are measured on
 * request, by two frames per second that only report that samples arrive, while the page is seen.
 */
export class Measuring {
  #gateway;
  #isOn = false;
  #seen = new Set(); // topics
  #measured = new Map(); // topic -> what ends it, and what the gateway says against it

  /** @param {import("../shared/gateway.js").Gateway} gateway */
  constructor(gateway) {
    this.#gateway = gateway;
    document.addEventListener("visibilitychange", () => this.tick());
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

  /** Return the figures of a topic in words, or why they are missing. */
  words(topic) {
    const measured = this.#measured.get(topic);
    const arrivals = this.arrivals(topic);
    if (arrivals) return wordsOf(arrivals);
    return measured ? measured.problem || say("arrivals.none") : "";
  }

  /** Measure what is to be measured now. Called once a second, so that scrolling by asks for nothing. */
  tick() {
    for (const [topic, measured] of this.#measured) {
      measured.ticksRefused += measured.isRefused ? 1 : 0;
      if (this.#isWanted(topic) && measured.ticksRefused < RETRY_TICKS) continue;
      measured.end();
      this.#measured.delete(topic);
    }
    for (const topic of this.#seen) if (this.#isWanted(topic) && !this.#measured.has(topic)) this.#measure(topic);
  }

  #isWanted(topic) {
    const isShown = this.#gateway.throttleOf(topic) !== undefined; // by a card
    const isPublished = Boolean(this.#gateway.graph.topics.get(topic)?.publishers.length);
    return this.#isOn && !document.hidden && this.#seen.has(topic) && isPublished && !isShown;
  }

  #measure(topic) {
    const measured = { end: () => {}, problem: "", isRefused: false, ticksRefused: 0 };
    this.#measured.set(topic, measured);
    measured.end = this.#gateway.subscribe(
      byOtherName(topic),
      { fields: [], throttle_rate: EVERY_MS },
      () => { measured.isRefused = false; }, // not any more, on another connection
      ({ level, msg }) => Object.assign(measured, { problem: msg, isRefused: level === "error" }),
    );
  }
}

/** Name a topic such that its frames come apart from those of the cards, which have the usual name. */
const byOtherName = (topic) => topic.slice(1);
