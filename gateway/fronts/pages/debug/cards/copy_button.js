// SPDX-License-Identifier: Apache-2.0
import { copy } from "../../shared/clipboard.js";
import { element } from "../../shared/dom.js";
import { say } from "../../shared/language.js";

const SAID_MS = 2000; // how long it says that it has copied

/**
 * Return a button that copies a text, and says so.
 * @param {{label: string, title: string}} words
 * @param {() => string} text may throw, in words
 * @param {(problem: string) => void} tell gets why it was not copied, or ""
 */
export function copyButton({ label, title }, text, tell) {
  const said = element("span", { className: "unseen", role: "status" }); // the name of the button stays, and is not read out again
  const button = element("button", { type: "button", title, aria: { label } }, say("copy"));
  let isSaid = 0;
  const report = (isCopied) => {
    clearTimeout(isSaid);
    button.textContent = isCopied ? say("copy.done") : say("copy");
    said.textContent = isCopied ? say("copy.done") : "";
    if (isCopied) isSaid = setTimeout(report, SAID_MS, false);
  };
  button.onclick = async () => {
    try {
      await copy(text());
      tell("");
      report(true);
    } catch (error) {
      report(false);
      tell(error.message);
    }
  };
  return element("span", {}, button, said);
}
