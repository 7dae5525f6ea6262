// SPDX-License-Identifier: Apache-2.0
// Which fields of a large message may be large themselves.

import { fieldOf } from "../forms/fields.js";

const MOST_ITEMS = 100; // of an array that is small

/**
 * Return the paths of the fields that are small, and of those that may be large.
 * @param {object} schema of a message, as `describe` gives it
 * @returns {{small: string[], large: string[]}}
 */
export function sorted(schema) {
  return within(fieldOf(schema), []);
}

/** @param {import("../forms/fields.js").Field} group @param {string[]} above the names of the groups that hold it */
function within({ fields = [] }, above) {
  const parts = fields.map((field) => {
    const names = [...above, field.name];
    const path = names.join(".");
    if (field.kind !== "group") return isLarge(field) ? { small: [], large: [path] } : { small: [path], large: [] };
    const its = within(field, names);
    return its.large.length ? its : { small: [path], large: [] }; // one path for all of it
  });
  return { small: parts.flatMap(({ small }) => small), large: parts.flatMap(({ large }) => large) };
}

/** @param {import("../forms/fields.js").Field} field */
function isLarge({ kind, most = Infinity }) {
  return (kind === "list" || kind === "row" || kind === "octets") && most > MOST_ITEMS;
}
