// SPDX-License-Identifier: Apache-2.0
import { element } from "../shared/dom.js";
import { say } from "../shared/language.js";
import { written } from "./numbers.js";

const MOST = 64; // of axes, and of buttons

/** The axes of a joystick as bars, and its buttons as lamps. */
export class JoyView {
  static title = say("view.joy");
  static types = ["sensor_msgs/msg/Joy"];

  options = { throttle_rate: 50 };
  #axes = [];
  #buttons = [];
  #rows = element("div", { className: "rows" });
  #lamps = element("ul", { className: "lamps", aria: { label: say("joy.buttons") } });
  #none = element("p", { className: "quiet", hidden: true }, say("joy.none"));

  constructor() {
    this.element = element("div", {}, this.#rows, this.#lamps, this.#none);
  }

  show({ axes, buttons }) {
    this.#none.hidden = axes.length + buttons.length > 0;
    while (this.#axes.length < Math.min(MOST, axes.length)) this.#addAxis();
    while (this.#buttons.length < Math.min(MOST, buttons.length)) this.#addButton();
    for (const [index, { bar, value }] of this.#axes.entries()) {
      bar.value = axes[index] ?? 0;
      value.textContent = written(axes[index]);
    }
    for (const [index, lamp] of this.#buttons.entries()) {
      lamp.dataset.on = buttons[index] ? "yes" : "no";
      lamp.textContent = buttons[index] ? say("joy.on", { index }) : String(index);
    }
  }

  #addAxis() {
    const index = this.#axes.length;
    const bar = element("meter", { min: -1, max: 1, aria: { label: say("joy.axis", { index }) } });
    const value = element("output");
    this.#axes.push({ bar, value });
    this.#rows.append(element("div", { className: "row" }, say("joy.axis", { index }), bar, value));
  }

  #addButton() {
    const lamp = element("li");
    this.#buttons.push(lamp);
    this.#lamps.append(lamp);
  }
}
