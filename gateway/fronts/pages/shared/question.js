// SPDX-License-Identifier: Apache-2.0
import { showDialog } from "./dialog.js";
import { element } from "./dom.js";
import { say } from "./language.js";

const LONGEST = 40; // characters

/**
 * Ask for a short text. Unlike `prompt` it holds up nothing: a robot that is driven goes on.
 * @param {string} words the question
 * @param {string} [text] that is there already
 * @returns {Promise<string>} "" if nothing was given
 */
export function ask(words, text = "") {
  const input = element("input", { type: "text", value: text, maxLength: LONGEST, required: true, autocomplete: "off" });
  const cancel = element("button", { type: "button" }, say("cancel"));
  const form = element("form", { method: "dialog" }, element("label", {}, words, input), element("div", { className: "buttons" }, element("button", { type: "submit", className: "act", value: "ok" }, say("ok")), cancel));
  const dialog = element("dialog", { className: "question", aria: { label: words } }, form);
  cancel.onclick = () => dialog.close();
  /** @type {HTMLDialogElement|null} */ (document.querySelector("dialog.question"))?.close(); // one question at a time
  document.body.append(dialog);
  showDialog(dialog);
  input.select();
  return new Promise((resolve) => {
    dialog.onclose = () => {
      dialog.remove();
      resolve(dialog.returnValue ? input.value.trim() : "");
    };
  });
}
