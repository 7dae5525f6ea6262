// SPDX-License-Identifier: Apache-2.0
import { element } from "../shared/dom.js";

const MOST = 200; // lines

/** `/rosout` as lines, the newest last. */
export class LogView {
  options = {};
  element = element("ul", { className: "log", tabIndex: 0 });

  keep(message) {
    const level = message.level >= 40 ? "error" : message.level >= 30 ? "warning" : "info";
    const time = new Date(message.stamp.sec * 1000).toLocaleTimeString();
    const line = `${time} ${message.name}: ${message.msg}`;
    const isAtEnd = this.element.parentElement.scrollTop + this.element.parentElement.clientHeight + 8
      >= this.element.parentElement.scrollHeight;
    this.element.append(element("li", { dataset: { level } }, line));
    while (this.element.childElementCount > MOST) this.element.firstElementChild.remove();
    if (isAtEnd) this.element.parentElement.scrollTop = this.element.parentElement.scrollHeight;
  }

  show() {}
}
