// SPDX-License-Identifier: Apache-2.0
import { element, span } from "./dom.js";
import { say } from "./language.js";

const LATE_MS = 1000;

/** Something that is seen, pale while what it shows is old, with words that say how old. */
export class Aging {
  #place;
  #lateMs;
  #words = element("p", { className: "age", hidden: true });

  /**
   * @param {HTMLElement} place that holds it
   * @param {Object<string, number>} [lateMs] by the word for a source after how long it is old, if not after a second
   */
  constructor(place, lateMs = {}) {
    this.#place = place;
    this.#lateMs = lateMs;
  }

  /** How old it is, or "". */
  get words() {
    return this.#words.textContent;
  }

  /**
   * Write how old it is: call it some times a second.
   * @param {Object<string, import("./arrivals.js").Arrivals|undefined>} sources its sources, by a word for each
   * @param {boolean} isConnected else everything is old
   */
  write(sources, isConnected) {
    const old = Object.entries(sources).filter(([word, its]) => its?.messages && (!isConnected || its.isOlder(this.#lateMs[word] ?? LATE_MS)));
    this.#words.textContent = old.map(([word, its]) => say("age", { source: say(`source.${word}`), age: span(its.ageMs) })).join(" · ");
    this.#words.hidden = !old.length;
    this.#place.classList.toggle("stale", old.length > 0);
    if (old.length && this.#words.parentElement !== this.#place) this.#place.append(this.#words);
  }
}
