// SPDX-License-Identifier: Apache-2.0
// Whether a robot does what it is told, by its odometry and its log.

import { say } from "./language.js";

const STILL_MS = 1000; // so long a robot may take to begin
const LOG_MS = 2000; // so old a warning may be that explains what the robot does now
const STILL = { linear: 0.005, angular: 0.01 }; // m/s and rad/s that do not count as motion
const MEASURED = 1.1; // so much of what was asked for odometry may miss
const QUOTED = 120; // characters of a warning: more would hide what matters on a phone
const WARNING = 30; // of rcl_interfaces/msg/Log

/** Compares the commands that go out with what comes back. */
export class Motion {
  #wish = { linear: 0, angular: 0 };
  #wishedMs = -Infinity; // when something moving was last asked for
  #sinceMs = Infinity; // since when commands that move go out
  #movedMs = -Infinity;
  #took = { linear: 0, angular: 0 }; // the fastest that it has moved
  #odometryMs = -Infinity;
  #reason = "";
  #reasonMs = -Infinity;

  /** Take a command in m/s and rad/s, and whether the gateway lets it through. */
  command(linear, angular, isPassed) {
    const now = performance.now();
    const isMoving = linear !== 0 || angular !== 0;
    this.#wish = { linear, angular };
    if (isMoving) this.#wishedMs = now;
    this.#sinceMs = isMoving && isPassed ? Math.min(this.#sinceMs, now) : Infinity;
  }

  /** Take a `nav_msgs/msg/Odometry`. */
  odometry({ twist: { twist: { linear, angular } } }) {
    const now = performance.now();
    this.#odometryMs = now;
    if (Math.hypot(linear.x, linear.y) < STILL.linear && Math.abs(angular.z) < STILL.angular) return;
    this.#movedMs = now;
    this.#took.linear = Math.max(this.#took.linear, Math.hypot(linear.x, linear.y));
    this.#took.angular = Math.max(this.#took.angular, Math.abs(angular.z));
    if (now - this.#reasonMs > LOG_MS) this.#reason = "";
  }

  /** Take a `rcl_interfaces/msg/Log`: a warning about the topic while commands go out is the reason why nothing moves. */
  log({ level, msg }, topic) {
    const now = performance.now();
    const name = topic.split("/").at(-1);
    if (level < WARNING || !name || !msg.includes(name) || now - this.#wishedMs > LOG_MS) return;
    this.#reason = msg.length > QUOTED ? `${msg.slice(0, QUOTED - 1)}…` : msg;
    this.#reasonMs = now;
  }

  /** The problem with the motion, or "". */
  get words() {
    const now = performance.now();
    if (this.#sinceMs === Infinity) return "";
    if (this.#odometryMs === -Infinity) return say("motion.unknown");
    if (now - this.#odometryMs > STILL_MS) return say("motion.silent");
    if (now - Math.max(this.#sinceMs, this.#movedMs) < STILL_MS) return "";
    const { linear, angular } = this.#wish;
    const reason = this.#reason && ` ${say("motion.says", { reason: this.#reason })}`;
    if (Math.abs(linear) <= MEASURED * this.#took.linear && Math.abs(angular) <= MEASURED * this.#took.angular) return say("motion.obstacle") + reason;
    const speeds = { linear: `${Math.abs(linear).toFixed(2)} m/s`, angular: `${Math.abs(angular).toFixed(2)} rad/s` };
    return say("motion.limit", { speeds: linear && angular ? say("motion.both", speeds) : speeds[linear ? "linear" : "angular"] }) + reason;
  }
}
