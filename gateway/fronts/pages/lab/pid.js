// SPDX-License-Identifier: Apache-2.0
// A controller of one quantity. Time is an argument.

const MAX_STEP_S = 0.5; // after a longer silence what was remembered means nothing
const FILTER_S = 0.05; // of the slope, some samples of odometry: its noise is not motion

/** A PID whose output is always finite and within its limit. */
export class Pid {
  #gains;
  #limit;
  #integral = 0;
  #slope = 0;
  #error = 0;
  #time = NaN;

  /**
   * @param {{proportional: number, integral: number, derivative: number}} gains
   * @param {number} limit of the output, in both directions
   */
  constructor(gains, limit) {
    this.#gains = gains;
    this.#limit = limit;
  }

  /** Forget the past: for a new setpoint. */
  reset() {
    this.#integral = this.#slope = 0;
    this.#time = NaN;
  }

  /** Return the output for an error (setpoint minus measurement) at a time in seconds. 0 if one of them is not finite. */
  step(error, now) {
    if (!Number.isFinite(error) || !Number.isFinite(now)) {
      this.reset();
      return 0;
    }
    const step = now - this.#time; // NaN at first
    if (step < 0 || step > MAX_STEP_S) this.reset();
    else if (step > 0) this.#slope += (step / (FILTER_S + step)) * ((error - this.#error) / step - this.#slope);
    const increment = this.#time < now ? this.#gains.integral * error * step : 0;
    this.#error = error;
    this.#time = now;
    const rest = this.#gains.proportional * error + this.#gains.derivative * this.#slope;
    // against windup: at the limit the integral grows no further
    if (Math.abs(rest + this.#integral + increment) <= this.#limit || increment * rest < 0) {
      this.#integral = within(this.#integral + increment, this.#limit);
    }
    return within(rest + this.#integral, this.#limit);
  }
}

const within = (value, limit) => Math.max(-limit, Math.min(limit, value));
