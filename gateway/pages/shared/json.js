// SPDX-License-Identifier: Apache-2.0
// Messages as text: what came as CBOR is written as it would have come as JSON.

const CHUNK = 0x6000; // octets at a time, a multiple of three: an argument each

/**
 * Return a message as JSON.
 * @param {any} message
 * @param {number} [indent]
 */
export function json(message, indent) {
  return JSON.stringify(message, (_, value) => plain(value), indent);
}

function plain(value) {
  if (value instanceof Uint8Array) return base64(value);
  if (ArrayBuffer.isView(value)) return Array.from(/** @type {any} */ (value), plain);
  return typeof value === "number" && !Number.isFinite(value) ? String(value) : value; // as `"nonfinite": "string"` has it
}

function base64(octets) {
  let text = "";
  for (let at = 0; at < octets.length; at += CHUNK) {
    text += btoa(String.fromCharCode(...octets.subarray(at, at + CHUNK)));
  }
  return text;
}
