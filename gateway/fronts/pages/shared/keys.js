// SPDX-License-Identifier: Apache-2.0
// Keys that are held.

// While one of these is down the system may keep to itself that another key is let go.
const MODIFIERS = ["Alt", "Control", "Meta", "OS"];

/**
 * Report the sum of the held keys until they are let go. This includes when the page is hidden, and
 * when a modifier or a menu may swallow the end of a key.
 * @param {Record<string, number[]>} keys codes, each with its direction
 * @param {(first: number, second: number) => void} report
 * @param {{where?: Window|HTMLElement, signal?: AbortSignal}} [options] keys count only while *where* has the focus, and until the signal
 * @returns {() => void} let go of everything, until it is pressed again
 */
export function watchKeys(keys, report, { where = window, signal } = {}) {
  const pressed = new Set();
  const sum = (axis) => [...pressed].reduce((all, code) => all + (keys[code][axis] ?? 0), 0);
  const tell = () => report(sum(0), sum(1));
  const letGo = () => {
    if (!pressed.size) return;
    pressed.clear();
    tell();
  };
  where.addEventListener("keydown", (/** @type {KeyboardEvent} */ event) => {
    if (!(event.code in keys) || isModified(event) || isTaken(event)) return;
    event.preventDefault(); // arrows would scroll
    if (event.repeat) return;
    pressed.add(event.code);
    tell();
  }, { signal });
  addEventListener("keydown", (event) => isModified(event) && letGo(), { signal, capture: true });
  addEventListener("keyup", (event) => {
    if (pressed.delete(event.code)) tell();
  }, { signal });
  whenUnseen(letGo, { where, signal });
  return letGo;
}

/** Let go when nobody looks at the page any more, or a menu is before it: that swallows the end of whatever is held. */
export function whenUnseen(letGo, { where, signal }) {
  addEventListener("blur", letGo, { signal });
  where.addEventListener("blur", letGo, { signal });
  addEventListener("pagehide", letGo, { signal });
  addEventListener("contextmenu", (event) => event.defaultPrevented || letGo(), { signal });
  document.addEventListener("visibilitychange", () => document.hidden && letGo(), { signal });
}

const KEY = "ros2-gateway.characters"; // of the storage of the browser

/** Return whether characters do anything, such as ? and W: who speaks to a computer may press them unawares. Other keys always do. */
export const areCharactersOn = () => localStorage.getItem(KEY) !== "off";

/** Let characters do something, or not. */
export function useCharacters(isOn) {
  if (isOn) localStorage.removeItem(KEY);
  else localStorage.setItem(KEY, "off");
}

/** Return whether the page ignores a key. It is for what has the focus: each for a text, a list, a menu or a dialog, the arrows for a slider. A number needs no space bar. */
export function isTaken({ target, code, key = "" }) {
  if (key.length === 1 && code !== "Space" && !areCharactersOn()) return true; // the space bar is STOP
  if (!(target instanceof Element)) return false;
  if (target instanceof HTMLInputElement && target.type === "range") return code.startsWith("Arrow");
  if (target instanceof HTMLInputElement && target.type === "number" && code === "Space") return false;
  return target.matches("input:not([type=button]), select, textarea, dialog *, [role=menu], [role=menu] *");
}

const isModified = ({ key, ctrlKey, metaKey, altKey }) => ctrlKey || metaKey || altKey || MODIFIERS.includes(key);
