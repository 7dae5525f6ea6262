// SPDX-License-Identifier: Apache-2.0
// From the JSON Schema of a message to the fields of a form, and from what is typed to JSON.

import { json } from "../../shared/json.js";
import { say } from "../../shared/language.js";

/**
 * A field of a form.
 * @typedef {object} Field
 * @property {string} name
 * @property {"group"|"list"|"row"|"integer"|"number"|"boolean"|"text"|"octets"|"time"} kind a `row` is a list of one value each
 * @property {string} about its comment in the definition
 * @property {Field[]} [fields] of a group
 * @property {Field} [item] of a list or a row
 * @property {number} [least] value, or number of items
 * @property {number} [most] value, number of items, or characters
 * @property {any} [fallback] the value that a message has without it
 * @property {Object<string, number|string>} [constants] values that have a name
 */

const OUTSIDE = ["NaN", "Infinity", "-Infinity"]; // numbers that JSON lacks. The gateway takes them as texts
const NESTED = new Set(["group", "list"]);

/**
 * Return the field that a schema describes.
 * @param {object} schema as `describe` gives it
 * @param {object} [root] the schema that its references point into
 * @returns {Field}
 */
export function fieldOf(schema, root = schema, name = "") {
  const { $ref: reference, description: about = "", ...its } = schema;
  if (reference) return { ...fieldOf(root.$defs[reference.replace("#/$defs/", "")], root, name), ...(about && { about }) };
  const common = { name, about, fallback: its.default };
  if (its.anyOf) return { ...common, kind: its.anyOf.some((each) => each.contentEncoding) ? "octets" : "time" };
  const [type] = [its.type].flat();
  switch (type) {
    case "object": return { ...common, kind: "group", fields: fieldsOf(its, root) };
    case "array": return listOf(common, fieldOf(its.items, root), its);
    case "integer": return { ...common, kind: "integer", least: its.minimum, most: its.maximum };
    case "number": return { ...common, kind: "number", least: its.exclusiveMinimum, most: its.exclusiveMaximum };
    case "boolean": return { ...common, kind: "boolean" };
    default: return { ...common, kind: "text", most: its.maxLength };
  }
}

function listOf(common, item, { minItems: least = 0, maxItems: most }) {
  return { ...common, kind: NESTED.has(item.kind) ? "list" : "row", item, least, most };
}

function fieldsOf({ properties = {}, "x-ros-constants": constants = {} }, root) {
  const fields = Object.entries(properties)
    .filter(([name, its]) => !(name === "seq" && its.description?.includes("ignored")))
    .map(([name, its]) => fieldOf(its, root, name));
  const plain = fields.filter(({ kind }) => kind === "integer" || kind === "text");
  for (const field of plain) {
    // Constants belong to no field: their names say to which, or there is but one.
    const named = Object.entries(constants).filter(([name]) => name.startsWith(`${field.name.toUpperCase()}_`));
    const its = named.length || plain.length > 1 ? named : Object.entries(constants);
    const right = its.filter(([, value]) => (typeof value === "string") === (field.kind === "text"));
    if (right.length) field.constants = Object.fromEntries(right);
  }
  return fields;
}

/**
 * Return what was typed as JSON, or undefined for what was left empty: the message then has its default.
 * @param {Field} field
 * @param {string} typed
 * @returns {string|undefined}
 * @throws {Error} in words, if it does not fit
 */
export function jsonOf(field, typed) {
  const text = typed.trim();
  if (field.kind === "text") return typed === "" ? undefined : textOf(field, typed);
  if (text === "") return undefined;
  return READERS[field.kind](field, text);
}

const SECONDS = /^([+-]?)(\d*)\.?(\d*)$/; // by its digits: as a number it would lose nanoseconds

/** Return the number that a text is, or NaN: also for 0x10, which is a number for JavaScript alone. */
const decimal = (text) => (/^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(text) ? Number(text) : NaN);

const READERS = {
  integer: (field, text) => {
    const named = String(Object.hasOwn(field.constants ?? {}, text) ? field.constants[text] : text);
    if (!/^[+-]?\d+$/.test(named)) throw new Error(say("field.integer", { text: shortened(text) }));
    const value = BigInt(named);
    if (field.least !== undefined && (value < BigInt(field.least) || value > BigInt(field.most))) {
      throw new Error(say("field.range", { least: field.least, most: field.most }));
    }
    return String(value); // as text: a number of JavaScript has 53 bits
  },
  number: (field, text) => {
    if (OUTSIDE.includes(text)) return JSON.stringify(text);
    const value = decimal(text);
    if (!Number.isFinite(value)) throw new Error(say("field.number", { text: shortened(text) }));
    if (field.most !== undefined && !(value > field.least && value < field.most)) throw new Error(say("field.large"));
    return JSON.stringify(value);
  },
  boolean: (_, text) => {
    if (text !== "true" && text !== "false") throw new Error(say("field.boolean", { text: shortened(text) }));
    return text;
  },
  time: (_, text) => {
    if (text === "now") return '"now"';
    const [, sign, whole, part] = SECONDS.exec(text) ?? [];
    if (!whole && !part) throw new Error(say("field.time", { text: shortened(text) }));
    const [sec, nanosec] = [Number(whole), Number(part.padEnd(9, "0").slice(0, 9))];
    if (sign !== "-") return JSON.stringify({ sec, nanosec });
    return JSON.stringify(nanosec ? { sec: -sec - 1, nanosec: 1e9 - nanosec } : { sec: 0 - sec, nanosec });
  },
  octets: (_, text) => {
    if (/^[\d\s,]+$/.test(text)) return rowOf({ item: { kind: "integer", least: 0, most: 255 } }, text.split(/[\s,]+/));
    if (!/^[A-Za-z0-9+/]+={0,2}$/.test(text)) throw new Error(say("field.octets"));
    return JSON.stringify(text);
  },
  row: (field, text) => rowOf(field, field.item.kind === "text" ? text.split("\n") : text.split(/[\s,]+/)),
};

function rowOf(field, texts) {
  const items = texts.filter((each) => each !== "");
  if (items.length < field.least || items.length > field.most) throw new Error(say("field.count", { expected: counted(field), count: items.length }));
  return `[${items.map((each) => jsonOf(field.item, each)).join(",")}]`;
}

/** @param {Field} field */
function textOf({ most }, text) {
  if (most !== undefined && [...text].length > most) throw new Error(say("field.characters", { most }));
  return JSON.stringify(text);
}

/** Return how many values a message has. A list counts as one. */
export function size({ kind, fields }) {
  return kind === "group" ? fields.reduce((sum, each) => sum + size(each), 0) : 1;
}

/** Return in words how many items a list has. */
export function counted({ least, most }) {
  if (most === undefined) return say("field.values.any");
  return least === most ? say("field.values", { count: most }) : say("field.values.most", { most });
}

/** Return in words what a field takes. */
export function expected(field) {
  const { kind, least, most, fallback } = field;
  const otherwise = (takes) => (fallback === undefined ? takes : say("field.else", { takes, value: json(fallback) }));
  switch (kind) {
    case "integer": return otherwise(least === undefined ? say("field.takes.integer") : say("range", { least, most }));
    case "number": return otherwise(say("field.takes.number"));
    case "text": return otherwise(most === undefined ? say("field.takes.text") : say("field.takes.short", { most }));
    case "time": return say("field.takes.time");
    case "octets": return say("field.takes.octets");
    case "row": return field.item.kind === "text" ? say("field.takes.lines", { values: counted(field) }) : say("field.takes.commas", { values: counted(field) });
    default: return "";
  }
}

const shortened = (text) => JSON.stringify(text.length > 40 ? `${text.slice(0, 40)} ...` : text);
