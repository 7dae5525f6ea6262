// SPDX-License-Identifier: Apache-2.0
import { element } from "../shared/dom.js";

const MOST = 200; // lines

/** `/rosout` as lines, the newest last. */
export class LogView {
  options = {};
  /** Nobody logs regularly: that nothing comes makes no line old. */
  isIrregular = true;
  element = element("ul", { className: "log", tabIndex: 0 });
  #waiting = []; // messages that came since lines were written, as while the card is paused

  keep(message) {
    this.#waiting.push(message);
    if (this.#waiting.length > MOST) this.#waiting.shift();
  }

  show() {
    const { scrollTop, clientHeight, scrollHeight } = this.element.parentElement;
    const isAtEnd = scrollTop + clientHeight + 8 >= scrollHeight;
    this.element.append(...this.#waiting.map(lineOf));
    this.#waiting = [];
    while (this.element.childElementCount > MOST) this.element.firstElementChild.remove();
    if (isAtEnd) this.element.parentElement.scrollTop = this.element.parentElement.scrollHeight;
  }
}

function lineOf({ level, stamp, name, msg }) {
  const kind = level >= 40 ? "error" : level >= 30 ? "warning" : "info";
  return element("li", { dataset: { level: kind } }, `${new Date(stamp.sec * 1000).toLocaleTimeString()} `, element("bdi", {}, name), ": ", element("bdi", {}, msg)); // a name turns no text around it
}
