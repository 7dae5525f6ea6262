// SPDX-License-Identifier: Apache-2.0
// The size of a card: in twelfths of the width of the page, and in rows.

import { element } from "../shared/dom.js";

export const COLUMNS = 12;
export const MOST_ROWS = 60;
const LEAST = { wide: 2, tall: 4 };
const STEPS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

/** @typedef {{element: HTMLElement, wide: number, tall: number, actions: {changed: () => void}}} Sized */

/** Give a card a size. 0 is what the style has for its kind. @param {Sized} card */
export function resize(card, wide, tall) {
  card.wide = wide && Math.max(LEAST.wide, Math.min(COLUMNS, Math.round(wide)));
  card.tall = tall && Math.max(LEAST.tall, Math.min(MOST_ROWS, Math.round(tall)));
  for (const name of ["wide", "tall"]) {
    if (card[name]) card.element.style.setProperty(`--${name}`, card[name]);
    else card.element.style.removeProperty(`--${name}`);
  }
  card.element.classList.toggle("sized", card.tall > 0);
}

/**
 * Return the corner that resizes a card: drag it, or use the arrow keys.
 * @param {any} card whose `element` is there by the time that the corner is used
 * @param {string} label
 */
export function resizable(card, label) {
  const grip = element("button", { type: "button", className: "grip", title: label, aria: { label } });
  let isHeld = false;
  grip.onpointerdown = (event) => {
    if (event.button) return;
    isHeld = true;
    grip.setPointerCapture(event.pointerId);
  };
  grip.onpointermove = ({ clientX, clientY }) => {
    if (!isHeld) return;
    const { left, top } = card.element.getBoundingClientRect();
    const { column, row, gap } = steps(card.element.parentElement);
    resize(card, (clientX - left + gap) / column, (clientY - top + gap) / row);
  };
  grip.onlostpointercapture = () => {
    if (isHeld) card.actions.changed();
    isHeld = false;
  };
  grip.onkeydown = (event) => {
    if (!Object.hasOwn(STEPS, event.key)) return;
    event.preventDefault(); // it would scroll
    const [across, down] = STEPS[event.key];
    const { width, height } = card.element.getBoundingClientRect();
    const { column, row, gap } = steps(card.element.parentElement);
    resize(card, across ? Math.round((width + gap) / column) + across : card.wide, down ? Math.round((height + gap) / row) + down : card.tall);
    card.actions.changed();
  };
  return grip;
}

/** Return how many pixels a card grows by a column and by a row, which is as high as a line of the list. */
function steps(cards) {
  const gap = parseFloat(getComputedStyle(cards).columnGap);
  const row = 1.5 * parseFloat(getComputedStyle(document.documentElement).fontSize);
  return { gap, column: (cards.clientWidth + gap) / COLUMNS, row: row + gap };
}
