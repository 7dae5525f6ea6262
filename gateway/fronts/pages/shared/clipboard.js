// SPDX-License-Identifier: Apache-2.0
import { say } from "./language.js";

/**
 * Copy a text. Browsers have `navigator.clipboard` on https and localhost only, and a robot's page is often on neither.
 * @throws {Error} in words, if the browser does not allow it
 */
export async function copy(text) {
  if (navigator.clipboard) {
    await navigator.clipboard.writeText(text);
    return;
  }
  const had = /** @type {HTMLElement|null} */ (document.activeElement);
  const area = document.createElement("textarea");
  area.value = text;
  area.style.position = "fixed"; // else the page would scroll to it
  document.body.append(area);
  area.select();
  const isCopied = document.execCommand("copy");
  area.remove();
  had?.focus();
  if (!isCopied) throw new Error(say("copy.https"));
}
