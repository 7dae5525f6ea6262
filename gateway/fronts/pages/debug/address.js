// SPDX-License-Identifier: Apache-2.0
// The cards that the address of the page keeps: after #, which no server gets to see.

import { isKnown } from "./cards/cards.js";

const NONE = ["cards", "none"]; // not silence, which a first visit is

/** Return the cards that the address names and what of it names none, or null if it is silent. */
export function read() {
  const kept = new URLSearchParams(location.hash.slice(1));
  const texts = kept.getAll("card");
  if (!texts.length && kept.get(NONE[0]) !== NONE[1]) return null;
  const parts = texts.map((text) => ({ text, card: cardOf(text) }));
  return { cards: parts.flatMap(({ card }) => card ?? []), unknown: parts.filter(({ card }) => !card).map(({ text }) => text) };
}

function cardOf(text) {
  const [view, rate, named = "", ...fields] = text.split(" ");
  const [topic, chosenType = ""] = named.split(":"); // which stands in no name of ROS
  return topic.startsWith("/") && isKnown(view) ? { view, rate: Number(rate) || 0, topic, chosenType, fields } : null;
}

/** Return whether the address asks for all topics to be measured. */
export const isMeasuring = () => new URLSearchParams(location.hash.slice(1)).has("measure");

/** Keep these cards in the address, or nothing of any, and whether all topics are measured. */
export function write(cards, isMeasuring) {
  const kept = new URLSearchParams(isMeasuring ? { measure: "all" } : {});
  if (cards?.length === 0) kept.append(NONE[0], NONE[1]);
  for (const { view, rate, topic, chosenType, fields } of cards ?? []) {
    const named = chosenType ? `${topic}:${chosenType}` : topic;
    kept.append("card", [view, rate, named, ...fields].join(" "));
  }
  history.replaceState(null, "", `${location.pathname}#${kept}`);
}
