// SPDX-License-Identifier: Apache-2.0
import { sentence } from "./control_words.js";
import { say } from "./language.js";
import { isHeld } from "./stop_held.js";

const STAMPED = "geometry_msgs/msg/TwistStamped";
export const COMMAND_TYPES = ["geometry_msgs/msg/Twist", STAMPED];

const LOST = {
  closed: say("control.closed"),
  token: say("control.token"),
};

/** The topic that moves the robot, as the gateway guards it. */
export class CommandTopic {
  /** Its state by the gateway, or null if nobody listens on it or there is no connection. @type {any} */
  state = null;
  /** Whether this client may watch, not drive. */
  isForbidden = false;
  #gateway;
  #wanted;
  #topic = "";
  #type = ""; // while a node listens
  #told;
  #forgets;
  #problem = ""; // why there is no state
  #silentS = 0;
  #isStopper = false; // whether this page has stopped the robot last
  #attempt; // hears that a command was refused because of another client

  /**
   * @param {import("./gateway.js").Gateway} gateway
   * @param {() => void} told is called when the state has changed, and when a held command is refused. Unless it `isFree`,
   *   everything has to be let go of
   * @param {string} [wanted] its name. By default the one that the gateway names first
   */
  constructor(gateway, told, wanted) {
    this.#gateway = gateway;
    this.#told = told;
    this.#wanted = wanted;
    this.#attempt = gateway.listen((frame) => this.#refused(frame));
    this.#forgets = [
      this.#attempt.end,
      gateway.on("state", ({ state }) => {
        this.#learnRole();
        this.#lose(LOST[state] ?? this.#problem);
      }),
      gateway.on("silence", (seconds) => this.#hush(seconds)),
      gateway.on("stopping", () => (this.#isStopper = true)),
      gateway.on("graph", () => this.#look()),
      gateway.on("control", (state) => this.#take(state)),
    ];
    this.#learnRole();
    if (gateway.isOpen) this.#watch();
  }

  /** Hear no more of it. */
  close() {
    for (const forget of this.#forgets) forget();
  }

  /** Take that this client may not drive, of whatever role it is, until there is a new connection. */
  forbid() {
    this.isForbidden = true;
    this.#told();
  }

  /** Whether what this page sends reaches the robot, which moves. */
  get isDriving() {
    return this.state?.holder === "you" && this.state.state === "moving";
  }

  /** Whether this page may drive: its role permits it, a node listens, no other client drives, STOP is not held, and the gateway answers. */
  get isFree() {
    return !this.isForbidden && this.state !== null && this.state.holder !== "other" && !this.#silentS && !isHeld();
  }

  /** The words for the person who drives. */
  get words() {
    if (this.#silentS) return say("control.silent", { seconds: this.#silentS });
    if (this.isForbidden) return say("control.forbidden");
    return this.state ? sentence(this.state) : this.#problem;
  }

  /** Publish a speed in m/s and rad/s. Return whether it was sent. */
  publish(linear, angular) {
    if (this.isForbidden) return false;
    const isMotion = linear !== 0 || angular !== 0;
    if (!this.#type || (isMotion && (this.#silentS || isHeld()))) {
      if (isMotion) this.#told();
      return false;
    }
    const twist = { linear: { x: linear }, angular: { z: angular } };
    const msg = this.#type === STAMPED ? { twist } : twist;
    // Each refusal of a command with an id is answered. Another client that only sends zeros is not in the way.
    const id = this.state.holder === "other" ? { id: this.#attempt.id } : {};
    return this.#gateway.send({ op: "publish", ...id, topic: this.#topic, type: this.#type, msg, monotonic_ms: Math.round(performance.now()) });
  }

  /** The name of the topic, "" before it is known. */
  get name() {
    return this.#topic;
  }

  /** Take control from any other client. Rejects with the gateway's words. */
  async acquire() {
    this.#take(await this.#gateway.ask({ op: "acquire_control", topic: this.#topic }));
  }

  /** Say before it is tried what the role does not permit. */
  #learnRole() {
    this.isForbidden = this.#gateway.isOpen && this.#gateway.hello?.role === "viewer";
  }

  /** Ask for the state, once a node listens. Its changes follow. */
  async #watch() {
    try {
      this.#take(await this.#gateway.ask({ op: "control", topic: this.#wanted, watch: true }));
    } catch (error) {
      if (!error.isLost) this.#lose(this.#refusal(error)); // or else it has been said
    }
  }

  /** Look whether a node listens. A robot that left and returns begins again. */
  #look() {
    if (!this.#type) this.#watch();
    else if (!this.#isHeard) this.#lose(this.#unheard);
  }

  #take(state) {
    if (this.#wanted && state.topic !== this.#wanted) return; // of another card
    const type = this.#gateway.graph.typeOf(state.topic);
    this.#topic = state.topic;
    if (!COMMAND_TYPES.includes(type) || !this.#isHeard) return this.#lose(this.#unheard);
    if (state.state === "moving") this.#isStopper = false;
    this.#type = type;
    this.state = { ...state, isStopper: this.#isStopper };
    this.#told();
  }

  #lose(problem) {
    this.#type = "";
    this.state = null;
    this.#silentS = 0;
    this.#isStopper = false;
    this.#problem = problem;
    this.#told();
  }

  /** Why the gateway does not tell the state, in words. */
  #refusal({ code, message }) {
    if (code === "not_found") return say("control.setting", { message });
    const [, names] = message.match(/name one of (.+)/) ?? [];
    if (names === "none") return say("control.none");
    if (this.#wanted || !names) return message;
    return say("control.several", { names, address: `${location.pathname}#command=${names.split(",")[0]}` });
  }

  #hush(seconds) {
    this.#silentS = seconds;
    this.#told();
  }

  #refused(frame) {
    this.#gateway.dispatchEvent(new CustomEvent("status", { detail: frame }));
    if (frame.level === "error") this.#told();
  }

  get #isHeard() {
    return (this.#gateway.graph.topics.get(this.#topic)?.subscribers ?? []).length > 0;
  }

  get #unheard() {
    return say("control.unheard", { topic: this.#topic });
  }
}
