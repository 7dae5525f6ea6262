// SPDX-License-Identifier: Apache-2.0
// Targets by Nav2, or any other node that serves NavigateToPose. It knows the obstacles. Each end of an approach also cancels a goal.

import { say } from "../shared/language.js";
import { sendGoal } from "../shared/goal.js";

const TYPE = "nav2_msgs/action/NavigateToPose";
const SUCCEEDED = 4; // of action_msgs/msg/GoalStatus

/** One goal at a time. */
export class Navigation {
  #gateway;
  /** The one on its way. @type {import("../shared/goal.js").Goal|null} */
  #goal = null;
  #told;

  /**
   * @param {import("../shared/gateway.js").Gateway} gateway
   * @param {(words: string) => void} told gets the progress, in words
   */
  constructor(gateway, told) {
    this.#gateway = gateway;
    this.#told = told;
  }

  /** The action, or "" while nobody serves it. */
  get action() {
    return [...this.#gateway.graph.actions.values()].find(({ types, nodes }) => types[0] === TYPE && nodes.length)?.name ?? "";
  }

  /** Whether a goal is on its way. */
  get isActive() {
    return this.#goal !== null;
  }

  /**
   * Send a goal. The gateway cancels it when this page is gone. Return whether it is on its way.
   * @param {{x: number, y: number, yaw: number, frame: string}} target
   */
  go({ x, y, yaw, frame }) {
    this.cancel();
    const { action } = this;
    const orientation = { z: Math.sin(yaw / 2), w: Math.cos(yaw / 2) };
    const args = { pose: { header: { frame_id: frame }, pose: { position: { x, y }, orientation } } };
    this.#goal = action ? sendGoal(this.#gateway, { action, action_type: TYPE, args }, {}, (each) => this.#heard(each)) : null;
    return this.isActive;
  }

  /** Cancel the goal, if there is one. */
  cancel() {
    if (!this.#goal) return;
    this.#goal.cancel();
    this.#end();
  }

  #heard({ op, level, msg, values, status, result }) {
    if (op === "action_feedback") {
      const left = values.distance_remaining;
      this.#told(Number.isFinite(left) ? say("nav2.left", { metres: left.toFixed(2) }) : say("nav2.drives"));
    } else if (op === "status" && level === "error") this.#fail(msg);
    else if (op === "action_result" && result && status === SUCCEEDED) {
      this.#end();
      this.#told(say("lab.arrived"));
    } else if (op === "action_result") this.#fail(result ? values.error_msg || say("nav2.error", { code: values.error_code }) : String(values));
  }

  #fail(why) {
    this.#end();
    this.#told(say("nav2.ended", { why }));
  }

  #end() {
    this.#goal?.end();
    this.#goal = null;
  }
}
