// SPDX-License-Identifier: Apache-2.0
import { element } from "../shared/dom.js";
import { say } from "../shared/language.js";
import { limitsOf } from "./joint_limits.js";
import { written } from "./numbers.js";

const DESCRIPTION = "robot_description";
const MOST_JOINTS = 200;
const NEAR = 0.05; // of the way between two limits

/** The positions of joints as bars between their limits, which the URDF on `robot_description` has. */
export class JointsView {
  static title = say("view.joints");
  static types = ["sensor_msgs/msg/JointState"];

  options = { throttle_rate: 66 };
  element = element("div", { className: "rows" });
  /** @type {Map<string, import("./joint_limits.js").Limit>} */
  #limits = new Map();
  #rows = new Map(); // name -> Joint
  #newest = null; // message
  #leftOut = element("p", { className: "quiet", hidden: true }, say("joints.many", { most: MOST_JOINTS }));
  #end;

  constructor(card) {
    const topic = card.topic.replace(/[^/]*$/, DESCRIPTION); // of the same robot
    this.#end = card.gateway.subscribe(topic, { type: "std_msgs/msg/String" }, ({ data }) => this.#limit(limitsOf(data)), () => {}); // without one, bars have no limits
  }

  show(message) {
    this.#newest = message;
    const { name: names, position, velocity, effort } = message;
    for (const [index, name] of names.entries()) {
      const row = this.#rows.get(name) ?? this.#add(name);
      row?.show(position[index], velocity[index], effort[index], this.#limits.get(name));
    }
  }

  close() {
    this.#end();
  }

  #limit(limits) {
    this.#limits = limits;
    if (this.#newest) this.show(this.#newest);
  }

  #add(name) {
    if (this.#rows.size >= MOST_JOINTS) {
      this.#leftOut.hidden = false;
      if (!this.#leftOut.isConnected) this.element.append(this.#leftOut);
      return null;
    }
    const row = new Joint(name);
    this.#rows.set(name, row);
    this.element.append(row.element);
    return row;
  }
}

/** One joint. */
class Joint {
  #bar;
  #value = element("output");

  constructor(name) {
    this.#bar = element("meter", { aria: { label: say("joints.of", { name }) } });
    this.element = element("div", { className: "row" }, element("bdi", {}, name), this.#bar, this.#value);
  }

  show(position, velocity, effort, { type = "", lower = NaN, upper = NaN } = {}) {
    const hasEnds = lower < upper;
    const value = Number.isFinite(position) ? position : 0;
    const margin = type === "continuous" ? 0 : (upper - lower) * NEAR;
    const isNear = hasEnds && (value < lower + margin || value > upper - margin);
    const [min, max] = hasEnds ? [lower, upper] : [-Math.PI, Math.PI];
    const shown = type === "continuous" ? Math.atan2(Math.sin(value), Math.cos(value)) : value;
    // in this order: a bar keeps each within the one before
    Object.assign(this.#bar, { min, max, low: min + (hasEnds ? margin : 0), high: max - (hasEnds ? margin : 0), optimum: (min + max) / 2, value: shown });
    const unit = type === "prismatic" ? "m" : "rad";
    const parts = [Number.isFinite(position) ? `${written(position)} ${unit}` : say("unmeasured")];
    if (Number.isFinite(velocity)) parts.push(`${written(velocity)} ${unit}/s`);
    if (Number.isFinite(effort)) parts.push(`${written(effort)} ${type === "prismatic" ? "N" : "N·m"}`);
    if (isNear) parts.push(value < lower || value > upper ? say("joints.beyond") : say("joints.near"));
    this.#value.textContent = parts.join(" · ");
  }
}
