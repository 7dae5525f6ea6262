// SPDX-License-Identifier: Apache-2.0
// What a person holds: keys, and a stick on the screen.

const KEYS = {
  ArrowUp: [1, 0], KeyW: [1, 0],
  ArrowDown: [-1, 0], KeyS: [-1, 0],
  ArrowLeft: [0, 1], KeyA: [0, 1],
  ArrowRight: [0, -1], KeyD: [0, -1],
};

/**
 * Report what is held, until it is let go: also when the window loses the focus, or is hidden.
 * @param {HTMLElement} stick
 * @param {HTMLElement} knob
 * @param {(linear: number, angular: number) => void} report in shares, -1 to 1; forward and left are positive
 * @param {Window|HTMLElement} [where] keys count only while this has the focus
 * @returns {{letGo: () => void, end: () => void}} let go of everything, until it is pressed anew, or for good
 */
export function watch(stick, knob, report, where = window) {
  const ending = new AbortController();
  const options = { signal: ending.signal };
  const pressed = new Set();
  let pushed = [0, 0];
  let pointer = null; // the one that holds the knob

  function tell() {
    const held = [...pressed].map((code) => KEYS[code]).concat([pushed]);
    report(held.reduce((sum, [linear]) => sum + linear, 0), held.reduce((sum, [, angular]) => sum + angular, 0));
  }

  function letGo() {
    pressed.clear();
    pointer = null;
    push([0, 0]);
  }

  function push(position) {
    pushed = position;
    const [linear, angular] = position;
    knob.style.transform = `translate(${-angular * 3.5}rem, ${-linear * 3.5}rem)`;
    tell();
  }

  function drag(event) {
    if (event.pointerId !== pointer) return; // one that was let go of pushes nothing, even if it stays down
    const { left, top, width, height } = stick.getBoundingClientRect();
    const right = (2 * (event.clientX - left)) / width - 1;
    const down = (2 * (event.clientY - top)) / height - 1;
    const length = Math.max(1, Math.hypot(right, down));
    push([-down / length, -right / length]);
  }

  where.addEventListener("keydown", (/** @type {KeyboardEvent} */ event) => {
    if (!(event.code in KEYS) || event.ctrlKey || event.metaKey || event.altKey || isTaken(event)) return;
    event.preventDefault(); // arrows would scroll
    if (event.repeat) return;
    pressed.add(event.code);
    tell();
  }, options);
  addEventListener("keyup", (event) => {
    if (pressed.delete(event.code)) tell();
  }, options);
  addEventListener("blur", letGo, options);
  if (where !== window) where.addEventListener("blur", letGo, options);
  addEventListener("pagehide", letGo, options);
  document.addEventListener("visibilitychange", () => document.hidden && letGo(), options);
  stick.addEventListener("pointerdown", (event) => {
    if (pointer !== null || event.button) return; // a menu would swallow the end of another button
    pointer = event.pointerId;
    stick.setPointerCapture(pointer);
    drag(event);
  }, options);
  stick.addEventListener("pointermove", drag, options);
  stick.addEventListener("lostpointercapture", (event) => {
    if (event.pointerId !== pointer) return;
    pointer = null;
    push([0, 0]);
  }, options);

  function end() {
    letGo();
    ending.abort();
  }

  return { letGo, end };
}

/** Whether a key is for what has the focus: all of them for a text, the arrows for a slider. */
function isTaken({ target, code }) {
  if (!(target instanceof HTMLInputElement) || target.type === "button") return false;
  return target.type !== "range" || code.startsWith("Arrow");
}
