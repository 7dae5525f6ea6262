// SPDX-License-Identifier: Apache-2.0
// From a target and odometry to commands, in steps: turn towards it, drive, turn again where the heading has drifted.
// Pure: pose and time are arguments. It sees no obstacle. One that stops the robot ends it for want of progress.

import { say } from "../shared/language.js";
import { Pid } from "./pid.js";

/** A TurtleBot3 Waffle Pi's, in m/s and rad/s. */
export const MOST = { linear: 0.26, angular: 1.82 };
export const TOLERANCE_M = 0.02; // leaves 3 cm of 5 for the odometry's faults
export const STALE_S = 0.5; // without a new pose for so long it drives blind
const FARTHEST_M = 200; // more than anybody points at: its odometry is out of its mind
const AIM_RAD = 0.05; // straighter ahead than this: turning ends
const DRIFT_RAD = 0.4; // farther off than this: turning begins again
const STEERING_M = 0.1; // nearer, the direction to the target is mostly noise
const STUCK_S = 5;
const NEARER_M = 0.01; // less is noise, no progress
const NEARER_RAD = 0.05;
const SPARE_S = 30; // beyond three times the straight way
const TURNING = { proportional: 2, integral: 0.1, derivative: 0.1 };
const DRIVING = { proportional: 1.2, integral: 0.1, derivative: 0.05 };

/** Drives to one target at a time. `state` is `idle`, `turning`, `driving`, `arrived` or `failed`, and `reason` says why it failed. */
export class Approach {
  state = "idle";
  reason = "";
  distance = NaN; // metres, at the last step
  target = { x: 0, y: 0 };
  #turning = new Pid(TURNING, MOST.angular);
  #driving = new Pid(DRIVING, MOST.linear);
  #command = { linear: 0, angular: 0 }; // one for all steps: no garbage
  #turn = 0;
  #begun = 0;
  #allowed = NaN; // seconds in all
  #progressed = 0; // when it last came nearer
  #bestDistance = Infinity;
  #bestTurn = Infinity;

  get isActive() {
    return this.state === "turning" || this.state === "driving";
  }

  /** Drive to a point of the odometry's frame, in metres, from the next step on. */
  begin(x, y, now) {
    if (!Number.isFinite(x + y + now)) return this.#end("failed", say("approach.infinite"));
    Object.assign(this.target, { x, y });
    this.#begun = this.#progressed = now;
    this.#allowed = NaN;
    this.#bestDistance = Infinity;
    this.#phase("turning", 0);
    return this.#command;
  }

  /** Drop the target. */
  stop() {
    this.#end("idle", "");
  }

  /**
   * Return what to do now, in m/s and rad/s. The same object each time.
   * @param {{x: number, y: number, yaw: number}} pose the newest
   * @param {number} poseTime when it came, in seconds of the clock of *now*
   * @param {number} now
   */
  step(pose, poseTime, now) {
    if (!this.isActive) return this.#give(0, 0);
    if (!(now - poseTime <= STALE_S) || !Number.isFinite(pose.x + pose.y + pose.yaw)) {
      return this.#end("failed", say("approach.blind", { seconds: STALE_S }));
    }
    const [ahead, left] = [this.target.x - pose.x, this.target.y - pose.y];
    this.distance = Math.hypot(ahead, left);
    if (this.distance <= TOLERANCE_M) return this.#end("arrived", "");
    if (this.distance > FARTHEST_M) return this.#end("failed", say("approach.far", { metres: FARTHEST_M }));
    if (Number.isNaN(this.#allowed)) this.#allowed = SPARE_S + (3 * this.distance) / MOST.linear;
    if (now - this.#begun > this.#allowed) return this.#end("failed", say("approach.late", { seconds: Math.round(now - this.#begun) }));
    const turn = wrapped(Math.atan2(left, ahead) - pose.yaw);
    if (this.state === "turning") this.#face(turn, now);
    else this.#drive(turn, now);
    if (this.#isNearer()) this.#progressed = now;
    if (now - this.#progressed > STUCK_S) return this.#end("failed", say("approach.stuck", { seconds: STUCK_S, metres: this.distance.toFixed(2) }));
    return this.#command;
  }

  #face(turn, now) {
    // With the target behind, noise makes left of right: keep to the way begun.
    const kept = this.#turn + wrapped(turn - this.#turn);
    this.#turn = Math.abs(kept) > 1.5 * Math.PI ? turn : kept;
    if (Math.abs(this.#turn) < AIM_RAD) {
      this.#phase("driving", turn);
      return this.#drive(turn, now);
    }
    return this.#give(0, this.#turning.step(this.#turn, now));
  }

  #drive(turn, now) {
    const ahead = this.distance * Math.cos(turn);
    const steers = this.distance > STEERING_M;
    // Near the target, what is left to its side takes another turn once it is abeam.
    const hasPassed = !steers && Math.abs(ahead) < TOLERANCE_M / 2;
    if (hasPassed || (steers && Math.abs(turn) > DRIFT_RAD)) {
      this.#phase("turning", turn);
      return this.#face(turn, now);
    }
    return this.#give(this.#driving.step(ahead, now), steers ? this.#turning.step(turn, now) : 0);
  }

  #phase(state, turn) {
    this.state = state;
    this.reason = "";
    this.#turn = turn;
    this.#bestTurn = Infinity;
    this.#turning.reset();
    this.#driving.reset();
  }

  #isNearer() {
    const isCloser = this.distance < this.#bestDistance - NEARER_M;
    if (isCloser) this.#bestDistance = this.distance;
    const isStraighter = this.state === "turning" && Math.abs(this.#turn) < this.#bestTurn - NEARER_RAD;
    if (isStraighter) this.#bestTurn = Math.abs(this.#turn);
    return isCloser || isStraighter;
  }

  #end(state, reason) {
    this.state = state;
    this.reason = reason;
    return this.#give(0, 0);
  }

  #give(linear, angular) {
    this.#command.linear = linear;
    this.#command.angular = angular;
    return this.#command;
  }
}

/** Return an angle between -pi and pi. */
export const wrapped = (angle) => Math.atan2(Math.sin(angle), Math.cos(angle));
