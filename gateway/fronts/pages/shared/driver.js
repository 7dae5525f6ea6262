// SPDX-License-Identifier: Apache-2.0
// Turns held keys into commands: repeated while you hold them, a zero when you let go.

const REPEAT_MS = 66; // 15 a second. The gateway stops the robot after 0.5 s without one
// The zeros that follow a stop of the gateway's own: it wants one before anything moves again.
const ZEROS = 3;

/** Sends commands while something is held. */
export class Driver {
  #send;
  #wish = { linear: 0, angular: 0 };
  #timer = 0;
  #zeros = 0;

  /** @param {(command: {linear: number, angular: number}) => void} send in shares of the limits, -1 to 1 */
  constructor(send) {
    this.#send = send;
  }

  /** Take what is held now. All zero when nothing is. */
  hold(linear, angular) {
    const was = this.#wish;
    this.#wish = { linear: within(linear), angular: within(angular) };
    if (!same(was, this.#wish)) this.#begin();
  }

  /** Send zeros, if nothing is held: after that the gateway lets the robot be driven. */
  ready() {
    if (isZero(this.#wish)) this.#begin();
  }

  #begin() {
    this.#zeros = ZEROS;
    this.#repeat();
  }

  #repeat() {
    clearTimeout(this.#timer);
    const isLast = isZero(this.#wish) && --this.#zeros <= 0;
    if (!isLast) this.#timer = setTimeout(() => this.#repeat(), REPEAT_MS);
    this.#send(this.#wish); // at last: where it is refused, what is held may be let go of within
  }
}

const within = (share) => Math.max(-1, Math.min(1, share));
const isZero = ({ linear, angular }) => linear === 0 && angular === 0;
const same = (one, other) => one.linear === other.linear && one.angular === other.angular;
