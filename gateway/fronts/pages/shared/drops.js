// SPDX-License-Identifier: Apache-2.0

/**
 * The messages of one topic that were dropped for this page. The gateway also counts messages that a throttle leaves out, and images that a newer one
 * replaced before they were encoded. The page asked for both, so it counts only while it asks for all messages.
 */
export class Drops {
  #before = null; // the gateway's count at the newest message. Null if the page asked for fewer messages

  /** Return how many were dropped since the last message, as far as that is known. */
  since({ dropped = 0 }, asksForFewer) {
    const before = this.#before;
    this.#before = asksForFewer ? null : dropped;
    return asksForFewer || before === null ? 0 : Math.max(0, dropped - before);
  }

  /** Begin again, as the gateway does with a new connection. */
  restart() {
    this.#before = null;
  }
}
