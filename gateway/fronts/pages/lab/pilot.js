// SPDX-License-Identifier: Apache-2.0
// Moves the robot by held keys, or to a target. Also knows everything that ends either.

import { say } from "../shared/language.js";
import { reason, sentence } from "../shared/control_words.js";
import { Driver } from "../shared/driver.js";
import { Approach, MOST, STALE_S } from "./approach.js";
import { Jumps } from "./jumps.js";

const STEP_MS = 50;
const SETTLE_MS = 300; // after such a stop it wants nothing that moves for 250 ms
const REARM_MS = 3000; // for the zeros that the gateway wants after it stopped the robot

/** Drives by keys or to a target, never both. */
export class Pilot {
  /** Its progress, in words. */
  words = "";
  approach = new Approach();
  #publish;
  #tell;
  #driver;
  #pose = null;
  #jumps = new Jumps();
  #poseMs = -Infinity;
  #state = null; // the gateway's state of the command topic
  #clearedMs = -Infinity; // when such a stop was over
  #aimedMs = 0;
  #isMoving = false; // whether the approach has begun to
  #forbidden = ""; // why this client may not drive, in words
  /** Drives to targets instead of this page, or null. @type {import("./navigation.js").Navigation|null} */
  navigation = null;
  /** Whether it drives to the next target. */
  isNavigating = false;

  /**
   * @param {(linear: number, angular: number) => void} publish in m/s and rad/s
   * @param {(words: string) => void} tell
   */
  constructor(publish, tell) {
    this.#publish = publish;
    this.#tell = tell;
    this.#driver = new Driver(({ linear, angular }) => this.#publish(linear * MOST.linear, angular * MOST.angular));
    setInterval(() => this.step(performance.now()), STEP_MS);
  }

  /** Whether a target is being approached. */
  get isActive() {
    return this.approach.isActive || Boolean(this.navigation?.isActive);
  }

  /** Take the progress of the navigation, in words. */
  navigated(words) {
    this.#say(words);
  }

  /** Whether there is a target, and the gateway lets nothing move yet. */
  get isWaiting() {
    return this.approach.isActive && !this.#isMoving;
  }

  /** Take where the robot is now. */
  odometry(pose) {
    this.#pose = pose;
    this.#poseMs = performance.now();
    const jump = this.#jumps.take(pose, this.#poseMs / 1000);
    if (jump && this.isActive) this.end(jump);
  }

  /**
   * Approach a place of the odometry's frame. Return whether that begins.
   * @param {{x: number, y: number}} place
   * @param {{x: number, y: number, yaw: number, frame: string}} [goal] the same for the navigation, in a frame that it knows
   */
  aim({ x, y }, goal) {
    const now = performance.now();
    const refusal = this.#refusal(now);
    if (refusal) {
      this.stop(refusal);
      return false;
    }
    this.#driver.hold(0, 0);
    this.approach.stop();
    if (this.isNavigating) return this.#navigate(goal);
    if (this.#state.tripped) this.#driver.ready();
    this.#aimedMs = now;
    this.#isMoving = false;
    this.approach.begin(x, y, now / 1000);
    this.step(now);
    if (this.isWaiting) this.#say(say("pilot.waiting"));
    return true;
  }

  /** Take why this client may not drive, or "" when nobody says so. */
  forbid(why) {
    if (why === this.#forbidden) return;
    this.#forbidden = why;
    if (why) this.stop(this.#mayLook());
  }

  /** Take what is held, in shares. Keys end an approach, and what is said of the one before is over. */
  hold(linear, angular) {
    if (this.isActive && (linear || angular)) this.#drop(say("pilot.keys"));
    else if ((linear || angular) && this.words) this.#say("");
    if (this.isActive) return;
    if (this.#forbidden && (linear || angular)) this.#say(this.#mayLook());
    this.#driver.hold(this.#forbidden ? 0 : linear, this.#forbidden ? 0 : angular);
  }

  /** Send zeros, so that the gateway lets the robot be driven. */
  ready() {
    this.#driver.ready();
  }

  /** Stop the robot and the approach, and say why it ended. Without an approach, say nothing. */
  end(why) {
    this.stop(this.isActive ? say("pilot.ended", { why }) : "");
  }

  /** Stop the robot and the approach, with words. */
  stop(words) {
    this.#drop(words);
    if (words) this.#say(words);
    this.#driver.hold(0, 0);
  }

  /** Take the state of the command topic, or null when it is not known any more. */
  told(state) {
    if (this.#state?.tripped && !state?.tripped) this.#clearedMs = performance.now();
    this.#state = state;
    if (!this.isActive) return;
    if (this.navigation?.isActive) this.#watchNavigation(state);
    else if (!state) this.end(say("end.nothing"));
    else if (state.holder === "other") this.stop(sentence(state));
    else if (state.tripped && this.#isMoving) this.end(reason(state));
  }

  /** Go on with the approach. */
  step(now) {
    if (!this.approach.isActive) return;
    if (!this.#isMoving && (this.#state.tripped || now - this.#clearedMs < SETTLE_MS)) {
      if (now - this.#aimedMs > REARM_MS) this.end(reason(this.#state) || say("end.still"));
      return;
    }
    if (!this.#isMoving) {
      const { x, y } = this.approach.target;
      this.#say(say("pilot.approaching", { x: x.toFixed(2), y: y.toFixed(2) }));
    }
    this.#isMoving = true;
    const { linear, angular } = this.approach.step(this.#pose, this.#poseMs / 1000, now / 1000);
    this.#driver.hold(linear / MOST.linear, angular / MOST.angular);
    if (this.approach.state === "arrived") this.#say(say("lab.arrived"));
    if (this.approach.state === "failed") this.#say(say("pilot.ended", { why: this.approach.reason }));
  }

  #navigate(goal) {
    this.#say(say("nav2.gets"));
    const isSent = Boolean(this.navigation?.action) && this.navigation.go(goal);
    if (!isSent) this.#say(say("nav2.none"));
    return isSent;
  }

  /** End the navigation by what stops a robot that the gateway sees. Other commands than those of the gateway do not tell it of an end. */
  #watchNavigation(state) {
    if (!state) this.end(say("end.nothing"));
    else if (state.holder === "other") this.stop(sentence(state));
    else if (state.tripped) this.end(reason(state) || say("end.stopped"));
  }

  #refusal(now) {
    if (this.#forbidden) return this.#mayLook();
    if (!this.#state) return say("pilot.nothing");
    if (this.#state.holder === "other" || this.#state.guard !== "ready") return sentence(this.#state);
    if (now - this.#poseMs > STALE_S * 1000) return say("pilot.blind", { seconds: STALE_S });
    return "";
  }

  #mayLook() {
    return say("pilot.forbidden", { why: this.#forbidden });
  }

  #drop(words) {
    if (!this.isActive) return;
    this.approach.stop();
    this.navigation?.cancel();
    this.#say(words);
  }

  #say(words) {
    this.words = words;
    this.#tell(words);
  }
}
