// SPDX-License-Identifier: Apache-2.0

/**
 * Return a text of a language. It knows no page, so that other pages can use it.
 * @param {Record<string, string>} words of the language, by key
 * @param {string} key
 * @param {Record<string, string|number>} [values] of what stands in braces
 */
export function worded(words, key, values = {}) {
  if (!Object.hasOwn(words, key)) throw new Error(`no words for ${key}`);
  return words[key].replace(/\{(\w+)\}/g, (_, name) => String(values[name]));
}
