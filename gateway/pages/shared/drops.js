// SPDX-License-Identifier: Apache-2.0

/**
 * What was dropped of one topic for this page. The gateway also counts what a throttle leaves out, and pictures that a newer one
 * replaced before they were encoded. The page asked for both, so it counts only while it asks for all messages.
 */
export class Drops {
  #before = null; // what the gateway had counted by the newest message. Null if the page asked for fewer messages

  /** Return how many were dropped since the last message, as far as that is known. */
  since({ dropped = 0 }, asksForFewer) {
    const before = this.#before;
    this.#before = asksForFewer ? null : dropped;
    return asksForFewer || before === null ? 0 : Math.max(0, dropped - before);
  }

  /** Begin anew, as the gateway does with a new connection. */
  restart() {
    this.#before = null;
  }
}
