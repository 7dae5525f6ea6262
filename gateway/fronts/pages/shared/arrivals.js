// SPDX-License-Identifier: Apache-2.0
import { bytes } from "./dom.js";

const LEAST_MS = 400; // between two messages that a rate is reckoned from: a burst has none
const LATE_MS = 2000;
const LEAST_HZ = 0.05; // less would be shown as 0
const REGULAR = 3; // messages: a topic that has sent this many should continue. A map stays valid

/** The messages that arrived of one topic, or for one card. `tick` is called once per second. */
export class Arrivals {
  messages = 0;
  dropped = 0; // for this page, while no throttle was asked for
  #bytes = 0; // of the newest
  #newest = { seq: 0, ms: 0 };
  #hz = 0;
  #reckoned = this.#newest; // the newest when the rate was computed

  /**
   * Count a message.
   * @param {number} bytes how large it is
   * @param {number} dropped how many were dropped before it
   * @param {number} [seq] its number on the topic, of which not all messages need to come here. By default that here
   */
  add(bytes, dropped, seq = this.#newest.seq + 1) {
    this.messages += 1;
    this.#bytes = bytes;
    this.dropped += dropped;
    this.#newest = { seq, ms: performance.now() };
    if (this.messages === 1 || seq < this.#reckoned.seq) this.#reckoned = this.#newest; // the gateway counts from 0 again
  }

  /** Reckon the rate, from the message that it was reckoned from before to the newest. */
  tick() {
    const ms = this.#newest.ms - this.#reckoned.ms;
    if (ms >= LEAST_MS) {
      this.#hz = ((this.#newest.seq - this.#reckoned.seq) * 1000) / ms;
      this.#reckoned = this.#newest;
    } else this.#hz = Math.min(this.#hz, 1000 / this.ageMs); // a silent topic is not that frequent
  }

  /** How old the newest message is, by the time of its arrival. */
  get ageMs() {
    return performance.now() - this.#newest.ms;
  }

  /** Whether messages came regularly, and no longer do. */
  get isLate() {
    return this.isOlder(LATE_MS);
  }

  /** Return whether messages came regularly, and none came for so long. */
  isOlder(ms) {
    return this.messages >= REGULAR && this.ageMs > ms;
  }

  /** Whether there is a rate to show: one message has none, such as a map that stays as it is. */
  get hasRate() {
    return this.#hz >= LEAST_HZ;
  }

  /** The rate in words, or "". */
  get rate() {
    return this.hasRate ? `${this.#hz < 9.5 ? this.#hz.toFixed(1).replace(".0", "") : Math.round(this.#hz)} Hz` : "";
  }

  /** The size of the newest message in words. */
  get size() {
    return bytes(this.#bytes);
  }
}
