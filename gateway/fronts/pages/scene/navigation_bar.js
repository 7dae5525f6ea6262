// SPDX-License-Identifier: Apache-2.0
import { element } from "../shared/dom.js";

/** The buttons by which a pointer or the keyboard does something else than to look around. Only one is pressed, or none. */
export class Tools {
  /** The pressed one, or "". */
  tool = "";
  #buttons;
  #chosen;

  /**
   * @param {Record<string, {name: string, hint: string}>} tools
   * @param {(tool: string) => void} chosen
   */
  constructor(tools, chosen) {
    this.#chosen = chosen;
    this.hints = Object.fromEntries(Object.entries(tools).map(([key, { hint }]) => [key, hint]));
    this.#buttons = Object.entries(tools).map(([key, { name, hint }]) => {
      const button = element("button", { type: "button", title: hint, dataset: { tool: key }, aria: { pressed: "false" } }, name);
      button.onclick = () => this.choose(this.tool === key ? "" : key);
      return button;
    });
    this.element = element("div", { className: "scene-tools", role: "group", aria: { label: "tools" } }, ...this.#buttons);
  }

  choose(tool) {
    this.tool = tool;
    for (const each of this.#buttons) each.setAttribute("aria-pressed", String(each.dataset.tool === tool));
    this.#chosen(tool);
  }
}

/** The progress of a goal, and the button that cancels it. */
export class GoalLine {
  #words = element("output", {});
  #cancel = element("button", { type: "button", hidden: true }, "Cancel");

  /** @param {import("./navigation.js").Navigation} navigation */
  constructor(navigation) {
    this.navigation = navigation;
    this.#cancel.onclick = () => navigation.cancel();
    this.element = element("div", { className: "goal-line" }, this.#words, this.#cancel);
  }

  write(words = this.navigation.words) {
    if (this.#words.textContent !== words) this.#words.textContent = words; // it is read out
    this.#cancel.hidden = !this.navigation.isActive;
  }
}

export const POSE_TOOLS = {
  go: { name: "Go here", hint: "Press where the robot is to go, and drag to where it is to look. With the keyboard: Enter, arrow keys, Enter." },
  place: { name: "I am here", hint: "Press where the robot is, and drag to where it looks. With the keyboard: Enter, arrow keys, Enter." },
};
