// SPDX-License-Identifier: Apache-2.0

/**
 * What was dropped of one topic for this page. The gateway counts what a throttle has left out, too, which was asked for: it is told
 * apart by counting only from one message to the next while there is no throttle.
 */
export class Drops {
  #before = null; // what the gateway had counted by the newest message; null if a throttle may have had a part in it

  /** Return how many were dropped since the last message, as far as that is known. */
  since({ dropped = 0 }, isThrottled) {
    const before = this.#before;
    this.#before = isThrottled ? null : dropped;
    return isThrottled || before === null ? 0 : Math.max(0, dropped - before);
  }

  /** Begin anew, as the gateway does with a new connection. */
  restart() {
    this.#before = null;
  }
}
