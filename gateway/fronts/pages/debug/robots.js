// SPDX-License-Identifier: Apache-2.0
// Several robots in one ROS graph: each has a namespace, or a prefix of its frames in tf, or both.

import { COMMAND_TYPES } from "../shared/command_topic.js";

// a namespace that has one of these is one of a robot
const OF_A_ROBOT = [...COMMAND_TYPES, "nav_msgs/msg/Odometry", "sensor_msgs/msg/JointState", "tf2_msgs/msg/TFMessage"];
const STATIC = "/tf_static";
const LISTEN_MS = 3000; // in which all nodes have sent their static frames

/**
 * Return the names of the robots.
 * @param {Iterable<{name: string, types: string[]}>} topics
 * @param {Iterable<string>} frames
 */
export function robotsOf(topics, frames) {
  const names = new Set();
  for (const { name, types } of topics) {
    const [, first, ...rest] = name.split("/");
    if (rest.length && types.some((each) => OF_A_ROBOT.includes(each))) names.add(first);
  }
  for (const frame of frames) {
    const [prefix, ...rest] = frame.replace(/^\//, "").split("/");
    if (rest.length) names.add(prefix);
  }
  return [...names].sort();
}

/** Return whether a name of ROS may be of a robot: it is in its namespace, or in that of no other robot. */
export const isOf = (name, robot, robots) => !robot || !robots.some((each) => each !== robot && name.split("/").includes(each));

/** The list of robots, which hides while there is no choice. */
export class RobotPicker {
  robot = "";
  #select;
  #gateway;
  #robots = [];
  #frames = new Set();
  #heard = ""; // the nodes whose static frames are known

  /**
   * @param {HTMLSelectElement} select
   * @param {import("../shared/gateway.js").Gateway} gateway
   * @param {{robot: string, all: string, changed: () => void}} about the one that is chosen at first, and the words for all of them
   */
  constructor(select, gateway, { robot, all, changed }) {
    this.robot = robot;
    this.#select = select;
    this.#gateway = gateway;
    select.onchange = () => {
      this.robot = select.value;
      changed();
    };
    gateway.on("graph", () => this.#learn(all));
  }

  /** Return whether a name may be of the chosen robot. */
  allows = (name) => isOf(name, this.robot, this.#robots);

  #learn(all) {
    const { topics } = this.#gateway.graph;
    this.#listen(String(topics.get(STATIC)?.publishers ?? ""), all);
    this.#robots = robotsOf(topics.values(), this.#frames);
    if (this.robot && !this.#robots.includes(this.robot)) this.#robots.push(this.robot); // it may come
    this.#select.hidden = this.#robots.length < 2 && !this.robot;
    const options = ["", ...this.#robots];
    if (String(options) === String([...this.#select.options].map(({ value }) => value))) return;
    this.#select.replaceChildren(...options.map((each) => new Option(each || all, each, false, each === this.robot)));
  }

  /** Listen for static frames for a moment, once for all nodes that publish them. By its other name, the cards do not notice it. */
  #listen(nodes, all) {
    if (nodes === this.#heard) return;
    this.#heard = nodes;
    if (nodes) setTimeout(this.#gateway.subscribe(STATIC.slice(1), {}, (message) => this.#take(message, all), () => {}), LISTEN_MS);
  }

  #take({ transforms }, all) {
    const before = this.#frames.size;
    for (const { header, child_frame_id: child } of transforms) this.#frames.add(header.frame_id).add(child);
    if (this.#frames.size > before) this.#learn(all);
  }
}
