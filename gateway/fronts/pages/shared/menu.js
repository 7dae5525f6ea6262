// SPDX-License-Identifier: Apache-2.0
import { element } from "./dom.js";

/**
 * An entry of a menu. `isOn` makes it one of several that can be chosen, or with `isSwitch` one that is on or off. `key` is a key that does the same. Without `act` it is a heading.
 * @typedef {{label: string, act?: () => void, isOn?: boolean, isSwitch?: boolean, key?: string, isOff?: boolean}} Entry
 */

const MORE = "⋯";
const EDGE = 4; // pixels between a menu and the edge of the screen

/**
 * Make a button that opens a menu of rare actions.
 * @param {string} label of the button and its menu
 * @param {() => Entry[]} entries the content of the menu. It is called each time that the menu opens
 * @param {string} [face] the visible text of the button
 * @returns {HTMLElement} the button with its menu
 */
export function menu(label, entries, face = MORE) {
  const list = element("div", { className: "menu", popover: "auto", role: "menu", tabIndex: -1, aria: { label } });
  const button = element("button", { type: "button", className: face === MORE ? "ghost more" : "ghost", title: label, aria: { label, haspopup: "menu", expanded: "false" } }, face);
  let isByPointer = false;
  button.popoverTargetElement = list;
  const leave = () => isByPointer && document.activeElement === button && button.blur(); // or the space bar would press it, and not STOP
  const close = () => {
    list.hidePopover(); // the button gets the focus now, and the event comes later
    leave();
  };
  button.addEventListener("click", ({ detail }) => { isByPointer = detail > 0; });
  list.addEventListener("beforetoggle", ({ newState }) => {
    button.setAttribute("aria-expanded", String(newState === "open"));
    if (newState !== "open") return;
    list.style.top = `${least()}px`; // at first: it is seen before it has its place
    list.replaceChildren(...entries().map((each) => entry(each, close)));
  });
  list.addEventListener("toggle", ({ newState }) => {
    if (newState === "open") {
      place(list, button);
      items(list)[0]?.focus();
    } else {
      list.replaceChildren();
      leave();
    }
  });
  list.addEventListener("keydown", (event) => move(event, list));
  return element("span", { className: "menu-place" }, button, list);
}

/** @param {Entry} about */
function entry({ label, act, isOn, isSwitch = false, key = "", isOff = false }, close) {
  if (!act) return element("p", { className: "quiet", role: "presentation" }, label);
  const made = element("button", { type: "button", className: "ghost", role: isOn === undefined ? "menuitem" : isSwitch ? "menuitemcheckbox" : "menuitemradio", tabIndex: -1, disabled: isOff }, element("span", {}, label), element("kbd", {}, key));
  if (isOn !== undefined) made.setAttribute("aria-checked", String(isOn));
  made.onclick = () => {
    close();
    act();
  };
  return made;
}

const items = (list) => [...list.querySelectorAll("button:enabled")];

/** Return the least top of a menu, in pixels. It stays below the bar: STOP is there. */
const least = () => (document.querySelector(".bar")?.getBoundingClientRect().bottom ?? 0) + EDGE;

/** Put an open menu below its button, or above it, where there is room. */
function place(list, button) {
  const { bottom, right, top } = button.getBoundingClientRect();
  const { offsetWidth: width, offsetHeight: height } = list;
  const isBelow = bottom + height + EDGE <= innerHeight || bottom < innerHeight / 2;
  list.style.left = `${Math.max(EDGE, Math.min(right, innerWidth - EDGE) - width)}px`;
  list.style.top = `${Math.max(least(), isBelow ? Math.min(bottom, innerHeight - height - EDGE) : top - height)}px`;
}

function move(event, list) {
  const all = items(list);
  const at = all.indexOf(document.activeElement);
  const next = { ArrowDown: all[at + 1] ?? all[0], ArrowUp: all.at(at - 1), Home: all[0], End: all.at(-1) }[event.key];
  if (event.key === "Tab") list.hidePopover();
  if (!next) return;
  event.preventDefault(); // it would scroll
  next.focus();
}
