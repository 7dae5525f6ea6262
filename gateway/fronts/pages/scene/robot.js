// SPDX-License-Identifier: Apache-2.0
import { say } from "../shared/language.js";
import { Display } from "./display.js";
import { RobotModel } from "./robot_model.js";

const JOINTS = "sensor_msgs/msg/JointState";

/** A robot by its description: its joints as the joint states of its namespace say, its root as the transforms say. */
export class RobotDisplay extends Display {
  options = {}; // all of a description, which comes once
  #model = null;
  #endJoints = () => {};
  #joints = "";
  #text = "";

  /** The frame of its root, or "". */
  get frame() {
    return this.#model ? this.#prefix + this.#model.root : "";
  }

  take({ data }) {
    if (data === this.#text) return; // latched messages come again
    this.#text = data;
    this.#model?.close();
    this.#model = null;
    try {
      this.#model = new RobotModel(this.context.gateway, data, this.context.changed);
      this.object.add(this.#model.object);
      this.problem = "";
    } catch (error) {
      this.problem = say("unshown", { why: error.message });
    }
    this.tick();
    this.context.changed();
  }

  tick() {
    if (!this.#model) return;
    this.within(this.frame);
    const [first = "", ...others] = this.#model.problems;
    this.problem = others.length ? say("robot.missing", { first, count: others.length }) : first;
    const joints = this.#namespace + "joint_states";
    if (this.#joints || this.context.gateway.graph.typeOf(joints) !== JOINTS) return;
    this.#joints = joints;
    this.#endJoints = this.context.gateway.subscribe(joints, { throttle_rate: 50, fields: ["name", "position"] }, (message) => {
      this.#model?.move(message);
      this.context.changed();
    }, () => {});
  }

  close() {
    this.#endJoints();
    this.#model?.close();
    super.close();
  }

  get #namespace() {
    return this.topic.slice(0, this.topic.lastIndexOf("/") + 1);
  }

  /** The text before the names of links in the names of frames: perhaps the namespace. */
  get #prefix() {
    const { names } = this.context.frames;
    const prefix = this.#namespace.slice(1);
    return prefix && names.has(prefix + this.#model.root) ? prefix : "";
  }
}
