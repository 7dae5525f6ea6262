// SPDX-License-Identifier: Apache-2.0
import { sentence } from "./control_words.js";

const STAMPED = "geometry_msgs/msg/TwistStamped";
export const COMMAND_TYPES = ["geometry_msgs/msg/Twist", STAMPED];

/** The topic that moves the robot, as the gateway guards it. */
export class CommandTopic {
  /** Its state by the gateway, or null if nobody listens on it or there is no connection. */
  state = null;
  /** What a person who drives reads. */
  words = "";
  #gateway;
  #wanted;
  #topic = "";
  #type = ""; // while somebody listens
  #told;
  #forgets;

  /**
   * @param {import("./gateway.js").Gateway} gateway
   * @param {() => void} told is called when the state has changed
   * @param {string} [wanted] its name; by default the one that the gateway names first
   */
  constructor(gateway, told, wanted) {
    this.#gateway = gateway;
    this.#told = told;
    this.#wanted = wanted;
    const changed = ({ state }) => {
      this.#type = "";
      this.state = null;
      if (state === "closed") this.words = "Not connected: the gateway stops what you drove.";
      told();
    };
    this.#forgets = [
      gateway.on("state", changed),
      gateway.on("graph", () => this.#watch()),
      gateway.on("control", (state) => this.#take(state)),
    ];
    if (gateway.isOpen) this.#watch();
  }

  /** Hear no more of it. */
  close() {
    for (const forget of this.#forgets) forget();
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
      this.#take(await this.#gateway.ask({ op: "control", topic: this.#wanted, watch: true }));
    } catch (error) {
      this.words = error.message;
      this.#told();
    }
  }

  #take(state) {
    if (this.#wanted && state.topic !== this.#wanted) return; // of another card
    const type = this.#gateway.graph.typeOf(state.topic);
    this.#topic = state.topic;
    this.#type = COMMAND_TYPES.includes(type) ? type : "";
    this.state = this.#type ? state : null;
    this.words = this.#type ? sentence(state) : `Nobody listens on ${state.topic}: there is nothing to drive.`;
    this.#told();
  }
}
