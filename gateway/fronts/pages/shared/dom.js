// SPDX-License-Identifier: Apache-2.0
// Elements and words. Texts from the robot become text nodes, never markup.

/**
 * Make an element.
 * @param {string} name
 * @param {Object<string, any>} [properties] of the element. `dataset` and `aria` are objects
 * @param {...(Node|string)} children
 * @returns {any} of the kind that the name says
 */
export function element(name, { dataset = {}, aria = {}, ...properties } = {}, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  Object.assign(made.dataset, dataset);
  for (const [key, value] of Object.entries(aria)) made.setAttribute(`aria-${key}`, value);
  made.append(...children);
  return made;
}

/**
 * Return the element of an id, which the page has.
 * @param {string} id
 * @returns {any} of any kind
 */
export const find = (id) => document.getElementById(id);

/** Return a name of ROS that breaks after slashes, except the first, and turns no text around it. */
export function breakable(name) {
  const made = document.createElement("bdi");
  for (const part of name.split(/(?<=.\/)/)) made.append(part, document.createElement("wbr"));
  return made;
}

/** Return a number of bytes as people read it. */
export function bytes(count) {
  if (count < 1000) return `${Math.round(count)} B`;
  if (count < 1e6) return `${(count / 1e3).toFixed(1)} kB`;
  return `${(count / 1e6).toFixed(2)} MB`;
}

/** Return a time of a recording as people read it. */
export const clock = (seconds) => `${Math.floor(seconds / 60)}:${String(Math.floor(seconds % 60)).padStart(2, "0")}`;

/** Return a time span as people read it. */
export function span(ms) {
  if (ms < 1000) return `${Math.round(ms)} ms`;
  if (ms < 60_000) return `${(ms / 1000).toFixed(1)} s`;
  return `${Math.floor(ms / 60_000)} min`;
}

const tokens = new Map(); // to ask the page takes a while, and a canvas asks often
globalThis.addEventListener?.("themechange", () => tokens.clear()); // as the first to hear it: who draws then imports this file

/** Return a CSS variable's value, for what is drawn on a canvas. */
export function token(name) {
  const known = tokens.get(name);
  if (known) return known;
  const value = getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
  tokens.set(name, value);
  return value;
}
