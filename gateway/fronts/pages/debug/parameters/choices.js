// SPDX-License-Identifier: Apache-2.0
// The values that a parameter may have, if its description lists them. ROS has no field for that: nodes write it as text.

const LISTS = /\b(?:one[ _]of|allowed(?: values)?|valid values|choices|enum|options)\b[<>\s]*(?:are|is)?[\s:=]*(.+)/i;
const MOST = 100;
const LONGEST = 64; // characters of a choice: more is a sentence

/**
 * Return the values that a text lists, such as "one of: fast, slow", or none.
 * @param {string} text `additional_constraints` of a parameter
 * @returns {string[]}
 */
export function choicesOf(text) {
  const list = LISTS.exec(text)?.[1] ?? (/^\s*\[.*\]\s*$/.test(text) ? text : "");
  const parts = list.replace(/[[\](){}]/g, " ").split(/[,|;]|\bor\b/).map((each) => each.trim().replace(/\s*\.$/, "").replace(/^(["'`])(.*)\1$/, "$2"));
  const found = parts.filter(Boolean);
  return found.length > 1 && found.length <= MOST && found.every((each) => each.length <= LONGEST) ? found : [];
}
