// SPDX-License-Identifier: Apache-2.0
// Held keys, and the joystick on the screen.

import { watchKeys, whenUnseen } from "./keys.js";

const KEYS = {
  ArrowUp: [1, 0], KeyW: [1, 0],
  ArrowDown: [-1, 0], KeyS: [-1, 0],
  ArrowLeft: [0, 1], KeyA: [0, 1],
  ArrowRight: [0, -1], KeyD: [0, -1],
};
const PRIMARY = 1; // of PointerEvent.buttons
const KNOB_REM = 3.5; // from the middle of the stick to its edge

/**
 * Report what is held, until it is let go: also when the window loses the focus, or is hidden.
 * @param {HTMLElement} stick
 * @param {HTMLElement} knob
 * @param {(linear: number, angular: number) => void} report in shares, -1 to 1. Forward and left are positive
 * @param {Window|HTMLElement} [where] keys count only while this has the focus
 * @param {HTMLElement} [zone] around the stick: a finger that touches it has the stick below it
 * @returns {{letGo: () => void, end: () => void, push: (linear: number, angular: number) => boolean}} let go of everything, until it is
 *   pressed again, or for good. `push`: what else is held, such as a gamepad. Returns whether it counts
 */
export function watch(stick, knob, report, where = window, zone = stick) {
  const ending = new AbortController();
  const { signal } = ending;
  let keys = [0, 0];
  let pushed = [0, 0];
  let others = [0, 0];
  const tell = () => {
    const isHeld = [...keys, ...pushed, ...others].some(Boolean);
    if (isHeld && stick.ariaDisabled === "true") return letGo(); // disabled. Once enabled, it has to be pressed again
    const [linear, angular] = [keys[0] + pushed[0] + others[0], keys[1] + pushed[1] + others[1]];
    point(knob, linear, angular);
    report(linear, angular);
  };
  const letGoOfKeys = watchKeys(KEYS, (...sum) => {
    keys = sum;
    tell();
  }, { where, signal });
  const letGoOfStick = watchStick(stick, zone, (...position) => {
    pushed = position;
    tell();
  }, signal);
  whenUnseen(letGoOfStick, { where, signal });

  function push(linear, angular) {
    if ((linear || angular) && stick.ariaDisabled === "true") return false;
    others = [linear, angular];
    tell();
    return true;
  }

  function letGo() {
    others = [0, 0];
    letGoOfKeys();
    letGoOfStick();
    tell();
  }

  function end() {
    letGo();
    ending.abort();
  }

  return { letGo, end, push };
}

/** Show by the knob where the robot is driven, also by keys. */
function point(knob, linear, angular) {
  const length = Math.max(1, Math.hypot(linear, angular));
  knob.style.transform = `translate(${(-angular / length) * KNOB_REM}rem, ${(-linear / length) * KNOB_REM}rem)`;
}

/**
 * Report where the knob of a stick is pushed to.
 * @param {HTMLElement} stick
 * @param {HTMLElement} zone
 * @param {(linear: number, angular: number) => void} report
 * @param {AbortSignal} signal
 * @returns {() => void} let go of the knob, until it is taken again
 */
function watchStick(stick, zone, report, signal) {
  let pointer = null; // the one that holds the knob
  let place = stick.getBoundingClientRect(); // the place of the joystick when it was taken: if it moves then, that is not a push

  function letGo() {
    if (pointer === null) return;
    pointer = null;
    stick.style.translate = "";
    report(0, 0);
  }

  function drag(event) {
    if (event.pointerId !== pointer) return; // one that was let go of pushes nothing, even if it stays down
    if (!(event.buttons & PRIMARY)) return letGo(); // nothing else tells of it while another button is down
    const { left, top, width, height } = place;
    const right = (2 * (event.clientX - left)) / width - 1;
    const down = (2 * (event.clientY - top)) / height - 1;
    const length = Math.max(1, Math.hypot(right, down));
    report(-down / length, -right / length);
  }

  zone.addEventListener("pointerdown", (event) => {
    const isBeside = event.target === zone && zone !== stick;
    if (pointer !== null || event.button || stick.ariaDisabled === "true" || (isBeside && event.pointerType !== "touch")) return;
    pointer = event.pointerId;
    if (isBeside) putBelow(stick, event);
    place = stick.getBoundingClientRect();
    zone.setPointerCapture(pointer);
    drag(event);
  }, { signal });
  zone.addEventListener("pointermove", drag, { signal });
  zone.addEventListener("lostpointercapture", (event) => event.pointerId === pointer && letGo(), { signal });
  zone.addEventListener("contextmenu", (event) => event.preventDefault(), { signal }); // a resting thumb also opens one
  addEventListener("resize", letGo, { signal }); // the screen was turned: the way ahead is to the side now
  return letGo;
}

/** Put the middle of a stick below a finger. */
function putBelow(stick, { clientX, clientY }) {
  const { left, top, width, height } = stick.getBoundingClientRect();
  stick.style.translate = `${clientX - left - width / 2}px ${clientY - top - height / 2}px`;
}
