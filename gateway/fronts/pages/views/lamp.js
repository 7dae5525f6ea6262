// SPDX-License-Identifier: Apache-2.0
import { element } from "../shared/dom.js";
import { say } from "../shared/language.js";

/** A lamp that is on while the newest message says true. */
export class LampView {
  static title = say("view.lamp");
  static types = ["std_msgs/msg/Bool"];

  options = {};
  element = element("p", { className: "lamp" });

  show({ data }) {
    this.element.dataset.on = data ? "yes" : "no";
    this.element.textContent = data ? say("lamp.on") : say("lamp.off");
  }
}
