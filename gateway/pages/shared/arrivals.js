// SPDX-License-Identifier: Apache-2.0
import { bytes, span } from "./dom.js";

const LATE_MS = 2000;
const REGULAR = 3; // messages: whoever has sent so many is expected to go on; a map is as good as it was

/** What has come of one topic, or for one card; `tick` is called once a second. */
export class Arrivals {
  messages = 0;
  dropped = 0; // for this page, while no throttle was asked for
  #bytes = 0; // of the newest
  #newestMs = 0;
  #hz = 0;
  #ticked = { messages: 0, ms: performance.now() };

  /** Count a message of so many bytes, before which so many were dropped. */
  add(bytes, dropped) {
    this.messages += 1;
    this.#bytes = bytes;
    this.dropped += dropped;
    this.#newestMs = performance.now();
  }

  /** Reckon the rate since the last call. */
  tick() {
    const ms = performance.now();
    this.#hz = ((this.messages - this.#ticked.messages) * 1000) / Math.max(1, ms - this.#ticked.ms);
    this.#ticked = { messages: this.messages, ms };
  }

  /** How old the newest message is, by the time of its arrival. */
  get ageMs() {
    return performance.now() - this.#newestMs;
  }

  /** Whether messages came regularly, and no longer do. */
  get isLate() {
    return this.isOlder(LATE_MS);
  }

  /** Return whether messages came regularly, and none came for so long. */
  isOlder(ms) {
    return this.messages >= REGULAR && this.ageMs > ms;
  }

  /** Rate, size and age in words. */
  get words() {
    if (!this.messages) return "nothing yet";
    const parts = [`${this.#hz < 9.5 ? this.#hz.toFixed(1).replace(".0", "") : Math.round(this.#hz)} Hz`, bytes(this.#bytes), `${span(this.ageMs)} old`];
    if (this.dropped) parts.push(`${this.dropped} dropped`);
    return parts.join(" · ");
  }
}
