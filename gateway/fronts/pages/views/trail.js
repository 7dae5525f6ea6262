// SPDX-License-Identifier: Apache-2.0
import { say } from "../shared/language.js";
import { insist, Plan, yawOf } from "./plan.js";

const MOST_PLACES = 2000;
const LEAST_STEP = 0.01; // metres
const LEAST_REACH = 1;

/** The newest places of something that moves. */
export class Trail {
  /** The last at the end. */
  places = [];
  /** The newest, or null. */
  pose = null;

  /** Go to a place. */
  extend(pose) {
    const last = this.places.at(-1);
    this.pose = pose;
    if (last && Math.hypot(pose.x - last.x, pose.y - last.y) < LEAST_STEP) return;
    this.places.push(pose);
    if (this.places.length > MOST_PLACES) this.places.shift();
  }

  /** Take another way, all of it. */
  take(poses) {
    this.places = poses.slice(-MOST_PLACES);
    this.pose = poses.at(-1) ?? null;
  }

  /** Draw a grid, and the way on it. There is at least one place. */
  draw(plan) {
    const xs = this.places.map(({ x }) => x);
    const ys = this.places.map(({ y }) => y);
    const [left, right, low, high] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    plan.begin({ x: (left + right) / 2, y: (low + high) / 2 }, Math.max(LEAST_REACH, right - left, high - low) * 0.55);
    plan.grid();
    plan.line(this.places);
  }
}

/** The way of something that moves, from above. Of a path all of it. */
export class TrailView {
  static title = say("view.trail");
  static types = ["nav_msgs/msg/Odometry", "nav_msgs/msg/Path", "geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/PoseWithCovarianceStamped"];

  options = { throttle_rate: 30 };
  #plan;
  #trail = new Trail();

  constructor(card) {
    this.#plan = new Plan(say("trail.label", { topic: card.topic }));
    this.element = this.#plan.element;
  }

  /** The newest places, the last at the end. */
  get places() {
    return this.#trail.places;
  }

  keep(message) {
    if (Array.isArray(message.poses)) this.#trail.take(message.poses.map((each) => poseOf(each)));
    else this.#trail.extend(poseOf(message));
  }

  show() {
    if (!this.#trail.pose) return;
    this.#trail.draw(this.#plan);
    this.#plan.robot(this.#trail.pose);
  }
}

/** Return the pose of a PoseStamped, or of a message that holds one with its covariance. */
function poseOf({ pose }) {
  const { position, orientation } = pose.pose ?? pose;
  insist(position.x, position.y);
  return { x: position.x, y: position.y, yaw: yawOf(orientation) };
}
