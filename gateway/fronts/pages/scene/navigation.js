// SPDX-License-Identifier: Apache-2.0
// Sends a robot to a place, and says where it is: for the scene and the map.

import { say } from "../shared/language.js";
import { isRefusal, sendGoal } from "../shared/goal.js";
import { isHeld } from "../shared/stop_held.js";

const ACTION = "nav2_msgs/action/NavigateToPose";
const GOAL = "goal_pose";
const PLACE = "initialpose";
const POSE = "geometry_msgs/msg/PoseStamped";
const POSE_WITH_COVARIANCE = "geometry_msgs/msg/PoseWithCovarianceStamped";
// a pose that is published cannot be taken back. Another one, such as where the robot seems to be, would move it
const UNENDING = say("goal.unending");
const ENDS = [4, 5, 6]; // succeeded, canceled and aborted, of action_msgs/msg/GoalStatus
// as RViz says of a place: 0.5 m, and 15 degrees
const COVARIANCE = Array.from({ length: 36 }, (_, at) => ({ 0: 0.25, 7: 0.25, 35: 0.07 })[at] ?? 0);

/** A place on the floor with a heading, in metres and radians. @typedef {{x: number, y: number, yaw: number}} Place */

/** One robot on its way. */
export class Navigation {
  /** The last event, in words, or "". */
  words = "";
  /** The place that it drives to, and its frame, or null. @type {(Place & {frame: string})|null} */
  target = null;
  #gateway;
  #changed;
  /** @type {import("../shared/goal.js").Goal|null} */
  #goal = null;
  #publishing = null; // the listener to what is said of a published pose
  #near;
  #forget;

  /**
   * @param {import("../shared/gateway.js").Gateway} gateway
   * @param {() => void} changed is called when there are other words, or another target
   * @param {() => string[]} near returns names of the robot that is meant, the most certain one first: what has several robots is chosen by them
   */
  constructor(gateway, changed, near = () => []) {
    this.#gateway = gateway;
    this.#changed = changed;
    this.#near = near;
    this.#forget = gateway.on("state", ({ state }) => state !== "open" && this.#goal && this.#end(say("goal.lost")));
  }

  /** Whether there is a goal that can be canceled. */
  get isActive() {
    return this.#goal !== null;
  }

  /** Return the words of a tool, with the name that gets what it gives, or else the last event. */
  wordsOf({ tool, hints }) {
    const action = tool === "go" && this.#findAction();
    if (tool === "go") return [hints.go, say("goal.to", { name: action || this.#find(GOAL) }), !action && UNENDING].filter(Boolean).join(" ");
    if (tool === "place") return `${hints.place} ${say("place.to", { name: this.#find(PLACE) })}`;
    return hints[tool] ?? this.words;
  }

  /** Announce what may be published, so that nodes hear the first pose. */
  prepare(isPlace) {
    if (!isPlace && this.#findAction()) return;
    this.#listen();
    this.#gateway.send({ op: "advertise", id: this.#publishing.id, ...(isPlace ? { topic: this.#find(PLACE), type: POSE_WITH_COVARIANCE } : { topic: this.#find(GOAL), type: POSE }) });
  }

  /** Send the robot to a place of a frame. */
  go(place, frame) {
    if (isHeld()) return this.#say(say("stop.held"));
    if (!frame) return this.#say(say("goal.frameless"));
    this.#leave();
    const pose = { header: { frame_id: frame }, pose: poseOf(place) };
    const action = this.#findAction();
    if (!action) {
      if (!this.#publish(this.#find(GOAL), POSE, pose)) return;
      this.target = { ...place, frame };
      this.#say(`${say("goal.sent", { topic: this.#find(GOAL), place: inWords(place) })} ${UNENDING}`);
      return;
    }
    this.#goal = sendGoal(this.#gateway, { action, action_type: ACTION, args: { pose } }, {}, (message) => this.#heard(message, place));
    if (!this.#goal) return this.#say(say("goal.unconnected"));
    this.target = { ...place, frame };
    this.#say(say("goal.going", { place: inWords(place) }));
  }

  /** Say where the robot is. */
  place(place, frame) {
    if (!frame) return this.#say(say("goal.frameless"));
    const pose = { header: { frame_id: frame }, pose: { pose: poseOf(place), covariance: COVARIANCE } };
    if (this.#publish(this.#find(PLACE), POSE_WITH_COVARIANCE, pose)) this.#say(say("place.sent", { topic: this.#find(PLACE), place: inWords(place) }));
  }

  cancel() {
    this.#goal?.cancel();
  }

  close() {
    this.#leave();
    this.#publishing?.end();
    this.#forget();
  }

  #findAction() {
    return this.#nearest([...this.#gateway.graph.actions.values()].filter(({ types, nodes }) => types.includes(ACTION) && nodes.length))?.name ?? "";
  }

  /** Return the topic of a name: the one that a node subscribes to, in any namespace. */
  #find(name) {
    const found = [...this.#gateway.graph.topics.values()].filter((each) => each.name.endsWith(`/${name}`));
    const heard = found.filter(({ subscribers }) => subscribers.length);
    return this.#nearest(heard.length ? heard : found)?.name ?? `/${name}`;
  }

  /** Return the one that has the most namespaces in common with the robot that is meant. */
  #nearest(found) {
    const names = this.#near().map(partsOf);
    const scores = new Map(found.map((each) => [each, names.map((name) => inCommon(name, partsOf(each.name)))]));
    const compare = (one, other) => scores.get(other).map((score, at) => score - scores.get(one)[at]).find(Boolean) ?? 0;
    return found.sort(compare)[0];
  }

  #listen() {
    this.#publishing ??= this.#gateway.listen(({ op, msg }) => op === "status" && this.#say(msg));
  }

  #publish(topic, type, msg) {
    this.#listen();
    if (this.#gateway.send({ op: "publish", id: this.#publishing.id, topic, type, msg })) return true;
    this.#say(say("goal.unconnected"));
    return false;
  }

  /** Cancel the goal and forget it: nobody could cancel it later. */
  #leave() {
    this.#goal?.cancel();
    this.#goal?.end();
    this.#goal = this.target = null;
  }

  #heard(message, place) {
    const { op, values, status, result, msg, level } = message;
    if (op === "action_feedback") {
      const left = values.distance_remaining;
      this.#say(Number.isFinite(left) ? say("goal.left", { place: inWords(place), metres: left.toFixed(1) }) : say("goal.going", { place: inWords(place) }));
    } else if (isRefusal(message)) this.#end(msg);
    else if (op === "status" && level !== "info") this.#say(msg);
    else if (op === "action_result") {
      const reason = result ? values.error_msg : String(values);
      const end = ENDS.includes(status) ? say(`goal.ended.${status}`) : result ? say("goal.ended") : say("goal.refused");
      this.#end([end, reason].filter(Boolean).join(" "));
    }
  }

  #end(words) {
    this.#goal?.end();
    this.#goal = this.target = null;
    this.#say(words);
  }

  #say(words) {
    this.words = words;
    this.#changed();
  }
}

/** Return the robot that the page is to show, or "". */
export const pickedRobot = () => /** @type {HTMLSelectElement|null} */ (document.getElementById("robot"))?.value ?? "";

const partsOf = (name) => name.split("/").filter(Boolean);

/** Return how many parts two names begin with in common. */
function inCommon(one, other) {
  const end = one.findIndex((part, at) => part !== other[at]);
  return end < 0 ? one.length : end;
}

/** Return a place as people read it. */
export const inWords = ({ x, y, yaw }) => say("place.heading", { x: x.toFixed(2), y: y.toFixed(2), degrees: Math.round((yaw * 180) / Math.PI) });

const poseOf = ({ x, y, yaw }) => ({ position: { x, y, z: 0 }, orientation: { x: 0, y: 0, z: Math.sin(yaw / 2), w: Math.cos(yaw / 2) } });
