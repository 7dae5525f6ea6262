// SPDX-License-Identifier: Apache-2.0
import { insist, Plan, yawOf } from "./plan.js";

const MOST_PLACES = 2000;
const LEAST_STEP = 0.01; // metres
const LEAST_REACH = 1;

/** The way of something that moves, from above. Of a path all of it. */
export class TrailView {
  options = { throttle_rate: 30 };
  #plan;
  /** The newest places, the last at the end. */
  places = [];
  #pose = null;

  constructor(card) {
    this.#plan = new Plan(`trail of ${card.topic}, seen from above`);
    this.element = this.#plan.element;
  }

  keep(message) {
    if (Array.isArray(message.poses)) this.#take(message.poses.map((each) => poseOf(each)));
    else this.#extend(poseOf(message));
  }

  show() {
    if (!this.#pose) return;
    const xs = this.places.map(({ x }) => x);
    const ys = this.places.map(({ y }) => y);
    const [left, right, low, high] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    const middle = { x: (left + right) / 2, y: (low + high) / 2 };
    this.#plan.begin(middle, Math.max(LEAST_REACH, right - left, high - low) * 0.55);
    this.#plan.grid();
    this.#plan.line(this.places);
    this.#plan.robot(this.#pose);
  }

  #take(poses) {
    this.places = poses.slice(-MOST_PLACES);
    this.#pose = poses.at(-1) ?? null;
  }

  #extend(pose) {
    const last = this.places.at(-1);
    this.#pose = pose;
    if (last && Math.hypot(pose.x - last.x, pose.y - last.y) < LEAST_STEP) return;
    this.places.push(pose);
    if (this.places.length > MOST_PLACES) this.places.shift();
  }
}

/** Return the pose of a PoseStamped, or of a message that holds one with its covariance. */
function poseOf({ pose }) {
  const { position, orientation } = pose.pose ?? pose;
  insist(position.x, position.y);
  return { x: position.x, y: position.y, yaw: yawOf(orientation) };
}
