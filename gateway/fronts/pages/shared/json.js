// SPDX-License-Identifier: Apache-2.0
// JSON with every digit of 64-bit integers. A message that arrived as CBOR is written as JSON.

const CHUNK = 0x6000; // octets at a time, a multiple of three: an argument each
const INTEGER = /^-?[0-9]+$/;
// A search for a long integer in every frame costs a sixth of JSON.parse. Only these characters stand before one.
const LONG_INTEGER = /[:,[\s]-?[0-9]{16}/; // or a string or fraction that looks so: that costs time and nothing else
const BARE_INTEGER = /^-?[0-9]{16}/; // apart: together they are slower

/**
 * Return the value of a JSON text. An integer that a number does not hold exactly becomes a BigInt. A browser that does not tell
 * the digits (before Chromium 114, Firefox 135, Safari 18.4) rounds it.
 * @param {string} text
 * @returns {any}
 * @throws {SyntaxError} if it is not JSON
 */
export function parse(text) {
  const isLong = LONG_INTEGER.test(text) || BARE_INTEGER.test(text);
  return isLong ? JSON.parse(text, exact) : JSON.parse(text); // a call for each value is slow
}

/**
 * Return an integer as a number, if it holds it exactly.
 * @param {bigint} value
 */
export function narrowed(value) {
  const number = Number(value);
  return Number.isSafeInteger(number) ? number : value;
}

/** @type {any} TypeScript does not know the third argument */
const exact = (_, value, context) => (Number.isInteger(value) && INTEGER.test(context?.source) ? narrowed(BigInt(context.source)) : value);

/**
 * Return a message as JSON. A BigInt becomes a number with all its digits.
 * @param {any} message
 * @param {number} [indent]
 */
export function json(message, indent) {
  return JSON.stringify(message, (_, value) => plain(value), indent);
}

function plain(value) {
  if (value instanceof Uint8Array) return base64(value);
  if (ArrayBuffer.isView(value)) return Array.from(/** @type {any} */ (value), plain);
  if (typeof value === "bigint") return written(value);
  return typeof value === "number" && !Number.isFinite(value) ? String(value) : value; // as `"nonfinite": "string"` has it
}

function written(integer) {
  const { rawJSON = String } = /** @type {any} */ (JSON); // a browser without it makes no BigInt of JSON either
  return rawJSON(String(integer));
}

function base64(octets) {
  let text = "";
  for (let at = 0; at < octets.length; at += CHUNK) {
    text += btoa(String.fromCharCode(...octets.subarray(at, at + CHUNK)));
  }
  return text;
}
