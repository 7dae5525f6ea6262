// SPDX-License-Identifier: Apache-2.0
import { sentence } from "./control_words.js";

const STAMPED = "geometry_msgs/msg/TwistStamped";
const TYPES = ["geometry_msgs/msg/Twist", STAMPED];

/** The topic that moves the robot, as the gateway guards it. */
export class CommandTopic {
  /** Its state by the gateway, or null if nobody listens on it or there is no connection. */
  state = null;
  /** What a person who drives reads. */
  words = "";
  #gateway;
  #topic = "";
  #type = ""; // while somebody listens
  #told;

  /**
   * @param {import("./gateway.js").Gateway} gateway
   * @param {() => void} told is called when the state has changed
   */
  constructor(gateway, told) {
    this.#gateway = gateway;
    this.#told = told;
    gateway.on("state", ({ state }) => {
      this.#type = "";
      this.state = null;
      if (state === "closed") this.words = "Not connected: the gateway stops what you drove.";
      told();
    });
    gateway.on("graph", () => this.#watch());
    gateway.on("control", (state) => this.#take(state));
  }

  /** Whether what this page sends reaches the robot, which moves. */
  get isDriving() {
    return this.state?.holder === "you" && this.state.state === "moving";
  }

  /** Publish a speed in m/s and rad/s; return whether it was sent. */
  publish(linear, angular) {
    if (!this.#type) return false;
    const twist = { linear: { x: linear }, angular: { z: angular } };
    const msg = this.#type === STAMPED ? { twist } : twist;
    return this.#gateway.send({ op: "publish", topic: this.#topic, type: this.#type, msg, monotonic_ms: Math.round(performance.now()) });
  }

  /** The name of the topic, "" before it is known. */
  get name() {
    return this.#topic;
  }

  /** Take control from whoever has it; rejects with the gateway's words. */
  async acquire() {
    this.#take(await this.#gateway.ask({ op: "acquire_control", topic: this.#topic }));
  }

  /** Ask for the state, once somebody listens; its changes follow. */
  async #watch() {
    if (this.#type) return;
    try {
      this.#take(await this.#gateway.ask({ op: "control", watch: true }));
    } catch (error) {
      this.words = error.message;
      this.#told();
    }
  }

  #take(state) {
    const type = this.#gateway.graph.typeOf(state.topic);
    this.#topic = state.topic;
    this.#type = TYPES.includes(type) ? type : "";
    this.state = this.#type ? state : null;
    this.words = this.#type ? sentence(state) : `Nobody listens on ${state.topic}: there is nothing to drive.`;
    this.#told();
  }
}
