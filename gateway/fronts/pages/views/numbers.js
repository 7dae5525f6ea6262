// SPDX-License-Identifier: Apache-2.0
// The numbers of a message. Integers of 64 bits may be a BigInt.

/** NaN and the infinities as they come in JSON. A string field that says one of them looks the same. */
export const NON_FINITE = ["NaN", "Infinity", "-Infinity"];

export const isNumber = (value) => typeof value === "number" || typeof value === "bigint" || NON_FINITE.includes(value);
