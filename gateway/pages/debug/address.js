// SPDX-License-Identifier: Apache-2.0
// What is shown, as the address of the page keeps it: after #, which no server gets to see.

import { isKnown } from "./cards/cards.js";

/** Return the cards that the address names, or null if it names none. */
export function read() {
  const cards = new URLSearchParams(location.hash.slice(1)).getAll("card").map((text) => {
    const [view, rate, topic, ...fields] = text.split(" ");
    return { view, rate: Number(rate) || 0, topic, fields };
  });
  return cards.length ? cards.filter(({ topic, view }) => topic?.startsWith("/") && isKnown(view)) : null;
}

/** Keep these cards in the address. */
export function write(cards) {
  const kept = new URLSearchParams();
  for (const { view, rate, topic, fields } of cards) kept.append("card", [view, rate, topic, ...fields].join(" "));
  history.replaceState(null, "", `${location.pathname}#${kept}`);
}
