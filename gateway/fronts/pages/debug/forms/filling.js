// SPDX-License-Identifier: Apache-2.0
// The way back: from a message to what would be typed into the fields of its form.

import { json, parse } from "../../shared/json.js";
import { say } from "../../shared/language.js";
import { jsonOf } from "./fields.js";

/** @typedef {import("./fields.js").Field} Field */

export const MOST_ITEMS = 100; // of a list, in a form
const OTHER_LINES = { row: /\r/, value: /[\r\n]/ }; // line breaks that a browser's field changes or drops

/** Return a value as it would be typed. */
export function written({ kind, item }, value) {
  if (value === undefined) return "";
  if (kind === "time" && isObject(value)) return secondsOf(value);
  if (Array.isArray(value)) return value.join(item?.kind === "text" ? "\n" : ", ");
  return String(value);
}

/** Return a time in seconds, with each of its nanoseconds: a number of JavaScript has 53 bits. */
function secondsOf({ sec = 0, nanosec = 0 }) {
  const isPast = sec < 0 && nanosec > 0;
  const [whole, part] = isPast ? [sec + 1, 1e9 - nanosec] : [sec, nanosec];
  const digits = `${isPast && whole === 0 ? "-" : ""}${whole}.${String(part).padStart(9, "0")}`;
  return digits.replace(/\.?0*$/, "");
}

/**
 * Refuse a value of which the fields would lose or change anything.
 * @param {Field} field
 * @param {any} value undefined where the message has its default
 * @param {string} [path] the names of the fields that it is in
 * @throws {Error} in words
 */
export function checkFit(field, value, path = "") {
  if (value === undefined) return;
  if (field.kind === "group") checkGroup(field, value, path);
  else if (field.kind === "list") checkList(field, value, path);
  else checkValue(field, value, path);
}

/** @param {Field} field */
function checkGroup({ fields }, value, path) {
  if (!isObject(value)) throw misfit(path || say("json.it"), say("json.object", { value: shown(value) }));
  for (const [name, its] of Object.entries(value)) {
    const inside = path ? `${path}.${name}` : name;
    const field = fields.find((each) => each.name === name);
    if (!field) throw misfit(inside, say("json.unknown"));
    checkFit(field, its, inside);
  }
}

/** @param {Field} field */
function checkList({ item, least = 0, most = Infinity }, value, path) {
  if (!Array.isArray(value)) throw misfit(path, say("json.list", { value: shown(value) }));
  const room = Math.min(most, MOST_ITEMS);
  if (value.length > room) throw misfit(path, say("json.many", { most: room, count: value.length }));
  if (value.length < Math.min(least, MOST_ITEMS)) throw misfit(path, say("json.few", { least, count: value.length }));
  for (const [index, each] of value.entries()) checkFit(item, each, `${path}.${index}`);
}

function checkValue(field, value, path) {
  const typed = written(field, value);
  let back;
  try {
    back = jsonOf(field, typed);
  } catch (error) {
    throw misfit(path, error.message);
  }
  const isSame = back === undefined ? isDefault(field, value) : json(whole(field, parse(back))) === json(whole(field, value));
  if (!isSame || OTHER_LINES[field.kind === "row" ? "row" : "value"].test(typed)) throw misfit(path, say("json.lost", { value: shown(value) }));
}

/** Return a time with both of its parts, in this order. Anything else as it is. */
const whole = ({ kind }, value) => (kind === "time" && isObject(value) ? { sec: 0, nanosec: 0, ...value } : value);

/** Return whether a message has this value where its field is left empty. */
function isDefault({ fallback }, value) {
  return fallback === undefined ? value === "" || (Array.isArray(value) && !value.length) : json(value) === json(fallback);
}

const isObject = (value) => typeof value === "object" && value !== null && !Array.isArray(value);
const misfit = (path, why) => new Error(say("json.stays", { path, why }));

function shown(value) {
  const text = json(value);
  return text.length > 40 ? `${text.slice(0, 40)} ...` : text;
}
