// SPDX-License-Identifier: Apache-2.0
import { COMMAND_TYPES } from "../shared/command_topic.js";
import { published } from "../shared/named_topics.js";

const LONGEST_MS = 30_000; // from the first card on: what a robot starts node by node is there by then
const FINGERS = "(max-width: 45rem), (pointer: coarse)"; // narrow as style.css has it
const VIEWS = [
  // of each line the first that the robot has
  [{ kind: "camera", view: "image" }],
  [{ kind: "map", view: "map" }, { kind: "scan", view: "scan" }],
  [{ kind: "odometry", view: "plot", fields: ["twist.twist.linear.x", "twist.twist.angular.z"] }],
];

/** Opens cards by itself if the address names none, until the user opens or closes one. */
export class FirstVisit {
  /** Whether nothing more is opened. */
  isOver = false;
  #gateway;
  #add;
  #missing = [...VIEWS];
  #hasStick = matchMedia(FINGERS).matches; // none there: a finger that scrolls would drive the robot
  #isAsking = false;
  #endMs = Infinity;

  /**
   * @param {import("../shared/gateway.js").Gateway} gateway
   * @param {(shown: import("./cards/card.js").Shown) => void} add opens a card
   */
  constructor(gateway, add) {
    this.#gateway = gateway;
    this.#add = add;
  }

  end() {
    this.isOver = true;
  }

  /** Open what the robot has by now. Called at each change of the graph. */
  fill() {
    if (performance.now() > this.#endMs) this.end();
    if (this.isOver) return;
    this.#missing = this.#missing.filter((kinds) => !this.#open(kinds));
    if (this.#missing.length === VIEWS.length) return;
    this.#endMs = Math.min(this.#endMs, performance.now() + LONGEST_MS);
    this.#drive();
  }

  /** Open the first of some kinds that a node publishes. Return whether there is one. */
  #open(kinds) {
    const shown = kinds.map((each) => ({ ...each, topic: published(this.#gateway.graph, each.kind) })).find((each) => each.topic);
    if (!shown) return false;
    const { topic, view, fields = [] } = shown;
    this.#add({ topic, view, fields, rate: 0 });
    return true;
  }

  /** Open what drives the robot, once there is one topic for that, if this client may. */
  async #drive() {
    if (this.#hasStick || this.#isAsking || this.#gateway.hello.role === "viewer") return;
    this.#isAsking = true;
    const { topic } = await this.#gateway.ask({ op: "control" }).catch(() => ({})); // there may be several, or none for this role
    this.#isAsking = false;
    if (this.isOver || !COMMAND_TYPES.includes(this.#gateway.graph.typeOf(topic))) return;
    this.#hasStick = true;
    this.#add({ topic, view: "drive", fields: [], rate: 0 });
  }
}
