// SPDX-License-Identifier: Apache-2.0
import { say } from "../shared/language.js";
import { insist, Plan, yawOf } from "./plan.js";

const MOST_POSES = 5000; // that are drawn: a particle filter has about as many
const LEAST_REACH = 0.5; // metres

/** All poses of a message as arrows from above, such as the particles of a localization. */
export class PosesView {
  static title = say("view.poses");
  static types = ["geometry_msgs/msg/PoseArray"];

  options = { compression: "cbor", throttle_rate: 100 };
  #plan;

  constructor(card) {
    this.#plan = new Plan(say("poses.label", { topic: card.topic }));
    this.element = this.#plan.element;
  }

  show({ poses }) {
    const every = Math.ceil(poses.length / MOST_POSES); // of many only some: spread, not the first
    const shown = poses.filter((_, index) => index % every === 0).map(({ position: { x, y }, orientation }) => ({ x, y, yaw: yawOf(orientation) }));
    for (const { x, y } of shown) insist(x, y);
    const [left, right] = ends(shown.map(({ x }) => x));
    const [low, high] = ends(shown.map(({ y }) => y));
    this.#plan.begin({ x: (left + right) / 2, y: (low + high) / 2 }, Math.max(LEAST_REACH, (right - left) * 0.55, (high - low) * 0.55));
    this.#plan.grid();
    for (const each of shown) this.#plan.robot(each, "accent");
  }
}

/** Return the least and the largest of some numbers. Of none 0. */
const ends = (numbers) => (numbers.length ? [Math.min(...numbers), Math.max(...numbers)] : [0, 0]);
