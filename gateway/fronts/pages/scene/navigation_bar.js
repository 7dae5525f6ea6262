// SPDX-License-Identifier: Apache-2.0
import { element } from "../shared/dom.js";
import { say } from "../shared/language.js";

/** The buttons by which a pointer or the keyboard does something else than to look around. Only one is pressed, or none. */
export class Tools {
  /** The pressed one, or "". */
  tool = "";
  #buttons;
  #chosen;

  /**
   * @param {string[]} tools
   * @param {(tool: string) => void} chosen
   */
  constructor(tools, chosen) {
    this.#chosen = chosen;
    this.hints = Object.fromEntries(tools.map((each) => [each, say(`tool.${each}.hint`)]));
    this.#buttons = tools.map((key) => {
      const button = element("button", { type: "button", title: this.hints[key], dataset: { tool: key }, aria: { pressed: "false" } }, say(`tool.${key}`));
      button.onclick = () => this.choose(this.tool === key ? "" : key);
      return button;
    });
    this.element = element("div", { className: "scene-tools", role: "group", aria: { label: say("tools") } }, ...this.#buttons);
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
  #cancel = element("button", { type: "button", hidden: true }, say("cancel"));

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

export const POSE_TOOLS = ["go", "place"];
