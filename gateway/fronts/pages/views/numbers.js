// SPDX-License-Identifier: Apache-2.0
// The numbers of a message. Integers of 64 bits may be a BigInt.

/** NaN and the infinities as they come in JSON. A string field that says one of them looks the same. */
export const NON_FINITE = ["NaN", "Infinity", "-Infinity"];

export const isNumber = (value) => typeof value === "number" || typeof value === "bigint" || NON_FINITE.includes(value);

/** Return a value in a few digits, for a place where it changes. @param {any} value */
export function written(value) {
  if (value === null || value === undefined) return "–";
  if (typeof value === "bigint" || Number.isInteger(value) || !isFinite(value)) return String(value);
  return Math.abs(value) < 1e-3 || Math.abs(value) >= 1e6 ? value.toExponential(2) : value.toFixed(3);
}

/** Return the value at a path of a message, such as `pose.position.x`, or undefined. */
export const valueAt = (message, path) => path.split(".").reduce((each, name) => each?.[name], message);

/** Return which field `subscribe` has to ask for to get a path: of an array all of it. */
export const asked = (path) => path.replace(/\.\d+(?=\.|$).*/, "");
