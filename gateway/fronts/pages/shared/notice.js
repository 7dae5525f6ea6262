// SPDX-License-Identifier: Apache-2.0
// The one sentence that a page shows to everybody, until what it says is over.

import { element, find } from "./dom.js";
import { say } from "./language.js";

/** The subject of a notice: a command topic, or an unknown one. @typedef {{state: any, isDriving: boolean}} Command */

const UNKNOWN = { state: null, isDriving: false };
const untilDriving = ({ isDriving }) => isDriving;

/** Return where it stands: above the page, so that it does not move a control under a finger. A click or Escape closes it. */
export function notice() {
  addEventListener("keydown", ({ key }) => key === "Escape" && tell(""));
  return element("p", { id: "notice", className: "notice", role: "alert", hidden: true, title: say("notice.close"), onclick: () => tell("") });
}

/**
 * Show a sentence to everybody, or nothing.
 * @param {string} text
 * @param {(command: Command) => boolean} [isOver] whether it is not true any more. By default, once the robot drives
 */
export function tell(text, isOver = untilDriving) {
  Object.assign(find("notice"), { textContent: text, hidden: !text, isOver });
}

/** Show a sentence no longer, if it is still what is shown. */
export function untell(text) {
  if (find("notice").textContent === text) tell("");
}

/** Show no longer what is over, by the state of a command topic or, without one, by what there is in ROS. */
export function review(command = UNKNOWN) {
  const shown = find("notice");
  if (!shown.hidden && shown.isOver(command)) tell("");
}
