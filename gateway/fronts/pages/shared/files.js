// SPDX-License-Identifier: Apache-2.0
// Files that a page writes or reads. None of them leaves this computer.

import { element } from "./dom.js";

/** Let the browser save a text as a file. */
export function save(name, text, type = "application/json") {
  const href = URL.createObjectURL(new Blob([text], { type }));
  element("a", { href, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(href), 0);
}

/**
 * Ask for a file.
 * @param {string} accept the kind of files that the browser offers, such as ".json"
 * @returns {Promise<File|null>} null if none was chosen
 */
export function open(accept) {
  const input = element("input", { type: "file", accept });
  return new Promise((resolve) => {
    input.onchange = () => resolve(input.files[0] ?? null);
    input.oncancel = () => resolve(null);
    input.click();
  });
}
