// SPDX-License-Identifier: Apache-2.0
import { parse } from "../../shared/json.js";
import { say } from "../../shared/language.js";

/**
 * Return the value of JSON that a person has typed.
 * @param {string} text
 * @throws {Error} in words, also for a number such as 1e400: the gateway would refuse the whole frame, and not say of which card
 */
export function valueOf(text) {
  let value;
  try {
    value = parse(text);
  } catch (error) {
    throw new Error(say("json.invalid", { message: error.message }), { cause: error });
  }
  const path = endless(value);
  if (path) throw new Error(say("json.infinite", { path: path.slice(1).join(".") || say("json.it") }));
  return value;
}

/** Return where a number is that has become infinite, as JSON has no such numbers. @returns {string[]|undefined} */
function endless(value, path = [""]) {
  if (typeof value === "number") return Number.isFinite(value) ? undefined : path;
  if (typeof value !== "object" || value === null) return undefined;
  for (const [name, its] of Object.entries(value)) {
    const found = endless(its, [...path, name]);
    if (found) return found;
  }
  return undefined;
}
