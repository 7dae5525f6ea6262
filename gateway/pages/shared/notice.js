// SPDX-License-Identifier: Apache-2.0
// The one sentence that a page shows to everybody.

import { find } from "./dom.js";

/** Show a sentence to everybody, or nothing. */
export function tell(text) {
  find("notice").textContent = text;
  find("notice").hidden = !text;
}

/** Show a sentence no longer, if it is still what is shown. */
export function untell(text) {
  if (find("notice").textContent === text) tell("");
}
