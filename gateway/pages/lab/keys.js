// SPDX-License-Identifier: Apache-2.0
// Keys that are held.

/**
 * Report the sum of what the held keys stand for, until they are let go: also when nobody looks at the page any more.
 * @param {Record<string, number[]>} keys codes, each with its direction
 * @param {(first: number, second: number) => void} report
 * @returns {() => void} let go of everything, until it is pressed anew
 */
export function watchKeys(keys, report) {
  const pressed = new Set();
  const sum = (axis) => [...pressed].reduce((all, code) => all + keys[code][axis], 0);
  const tell = () => report(sum(0), sum(1));
  const letGo = () => {
    if (!pressed.size) return;
    pressed.clear();
    tell();
  };
  addEventListener("keydown", (event) => {
    if (!(event.code in keys) || event.ctrlKey || event.metaKey || event.altKey || isTyping(event.target)) return;
    event.preventDefault(); // arrows would scroll
    if (event.repeat) return;
    pressed.add(event.code);
    tell();
  });
  addEventListener("keyup", (event) => {
    if (pressed.delete(event.code)) tell();
  });
  addEventListener("blur", letGo);
  addEventListener("pagehide", letGo);
  document.addEventListener("visibilitychange", () => document.hidden && letGo());
  return letGo;
}

const isTyping = (target) => target.matches?.("input, select, textarea, dialog *");
