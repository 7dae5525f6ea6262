// SPDX-License-Identifier: Apache-2.0
// STOP: the button, its key, and what became of it in words.

import { COMMAND_TYPES } from "./command_topic.js";
import { element, find } from "./dom.js";
import { isTaken } from "./keys.js";
import { say } from "./language.js";
import { tell } from "./notice.js";
import { hold } from "./stop_held.js";

const SOON_MS = 500; // the gateway's deadline: by then it has stopped what this page drove, if the link is dead

/**
 * Return the button that stops the robot, even if another client drives.
 * @param {import("./gateway.js").Gateway} gateway
 */
export function stopButton(gateway) {
  const button = element("button", { id: "stop", className: "stop", type: "button", title: say("stop.about") }, "STOP");
  let isPressed = false; // by a pointer, which may have a click to come
  button.onpointerdown = ({ pointerId, button: which }) => { // a second finger makes no click
    isPressed = true;
    if (which === 0) hold(pointerId); // the end of another button a menu may swallow
    stop(gateway);
  };
  button.onclick = ({ detail }) => {
    if (detail === 0 || !isPressed) stop(gateway); // a key, or a screen reader
    isPressed = false;
  };
  button.onkeydown = (event) => {
    if (event.repeat) event.preventDefault();
    else if (["Space", "Enter", "NumpadEnter"].includes(event.code) && !event.metaKey) hold(event.code); // whose end Meta may swallow
  };
  return button;
}

/**
 * Press STOP by the space bar, unless that is for what has the focus.
 * @param {{where?: Window|HTMLElement, isMoving?: () => boolean}} [options] while something moves, buttons and lists do not keep it
 */
export function stopBySpace({ where = window, isMoving = () => false } = {}) {
  const isKept = (event) => (isMoving() ? isIn(event.target, "input, textarea") && isTaken(event) : isIn(event.target, "button") || isTaken(event));
  where.addEventListener("keydown", (/** @type {KeyboardEvent} */ event) => {
    if (event.code !== "Space" || isKept(event)) return;
    event.preventDefault();
    if (event.repeat) return;
    hold(event.code);
    find("stop").click();
  });
}

const isIn = (target, selector) => target instanceof Element && target.closest(selector) !== null;

async function stop(gateway) {
  const late = setTimeout(() => tell(say("stop.late")), SOON_MS);
  try {
    const { topics } = await gateway.stop();
    if (topics.length) tell(say("stop.done", { topics: topics.join(", ") }));
    else tell(say("stop.nothing"), ({ state }) => state !== null || isDriveable(gateway.graph));
  } catch (error) {
    tell(error.isLost ? say("stop.lost", { why: error.message }) : say("stop.refused", { why: error.message }));
  } finally {
    clearTimeout(late);
  }
}

/** Return whether a node listens to commands. */
const isDriveable = ({ topics }) => [...topics.values()].some(({ types, subscribers }) => subscribers.length && COMMAND_TYPES.includes(types[0]));
