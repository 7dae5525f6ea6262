// SPDX-License-Identifier: Apache-2.0
// Which field of a message a view shows.

import { element } from "../shared/dom.js";
import { TreeView } from "./tree.js";

/** The fields of types that have only one of interest. Any other is chosen by the user. */
const OWN_FIELDS = {
  "sensor_msgs/msg/Temperature": "temperature",
  "sensor_msgs/msg/RelativeHumidity": "relative_humidity",
  "sensor_msgs/msg/Illuminance": "illuminance",
  "sensor_msgs/msg/FluidPressure": "fluid_pressure",
};
const NUMBERS = ["Float32", "Float64", "Int8", "Int16", "Int32", "Int64", "UInt8", "UInt16", "UInt32", "UInt64"].map((each) => `std_msgs/msg/${each}`);

/** Types with one number that matters. */
export const NUMBER_TYPES = [...NUMBERS, ...Object.keys(OWN_FIELDS)];

/** Return the field that a card shows: the chosen one, or the one of its type that matters, or "". */
export const fieldOf = ({ fields, type }) => fields[0] ?? OWN_FIELDS[type] ?? (type.startsWith("std_msgs/") ? "data" : "");

/** The fields of a message, until one of them is chosen. */
export class Choice {
  #place;
  #tree;
  #said;

  /**
   * @param {HTMLElement} place
   * @param {string} question
   * @param {(path: string) => void} chosen
   */
  constructor(place, question, chosen) {
    this.#tree = new TreeView({ plot: chosen });
    this.options = this.#tree.options;
    this.#said = element("div", {}, question, " ", this.#tree.element);
    this.#place = place;
  }

  show(message) {
    if (!this.#said.isConnected) this.#place.append(this.#said);
    this.#tree.show(message);
  }
}
