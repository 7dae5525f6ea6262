// SPDX-License-Identifier: Apache-2.0
// The part of the address after #, which no server gets to see. It keeps tabs, their cards, and a few words.

import { isKnown } from "./cards/cards.js";
import { MOST_TABS } from "./desk.js";

const NONE = ["cards", "none"]; // not silence, which a first visit is

/** @typedef {{name: string, cards: import("./cards/card.js").Shown[]}} Tab */

/**
 * Return the tabs and cards that an address names, which of the tabs is shown, and what of it names none. Null if it is silent.
 * @returns {{tabs: Tab[], at: number, unknown: string[]}|null}
 */
export function read(hash = location.hash) {
  const kept = new URLSearchParams(hash.replace(/^#/, ""));
  if (!kept.has("card") && !kept.has("tab") && kept.get(NONE[0]) !== NONE[1]) return null;
  const [tabs, unknown] = [/** @type {Tab[]} */ ([]), []];
  let card = null; // that was named last
  for (const [key, text] of kept) {
    if (key === "tab" && tabs.length < MOST_TABS) tabs.push({ name: text, cards: [] });
    if (key === "card" && !tabs.length) tabs.push({ name: "", cards: [] });
    if (key === "card") {
      card = cardOf(text);
      if (card) tabs.at(-1).cards.push(card);
      else unknown.push(text);
    }
    const size = key === "size" && /^(\d{1,2})x(\d{1,2})$/.exec(text);
    if (size && card) Object.assign(card, { wide: Number(size[1]), tall: Number(size[2]) });
  }
  if (!tabs.length) tabs.push({ name: "", cards: [] });
  return { tabs, at: Math.max(0, Math.min(tabs.length, Number(kept.get("shown")) || 1) - 1), unknown };
}

function cardOf(text) {
  const [view, rate, named = "", ...rest] = text.split(" ");
  const [topic, chosenType = ""] = named.split(":"); // which stands in no name of ROS
  const fields = rest.filter((each) => !each.includes("=")); // which stands in no name of a field
  const settings = Object.fromEntries(new URLSearchParams(rest.filter((each) => each.includes("=")).join("&")));
  return topic.startsWith("/") && isKnown(view) ? { view, rate: Number(rate) || 0, topic, chosenType, fields, settings } : null;
}

/** Return a word that the address keeps, such as `measure` or `robot`, or "". */
export const word = (key) => new URLSearchParams(location.hash.slice(1)).get(key) ?? "";

/**
 * Keep tabs in the address, or nothing of any.
 * @param {Tab[]|null} tabs
 * @param {number} at which tab is shown
 * @param {Record<string, string>} words others to keep, unless they are ""
 */
export function write(tabs, at, words) {
  const kept = new URLSearchParams(Object.entries(words).filter(([, text]) => text));
  const cards = tabs?.flatMap((each) => each.cards);
  if (cards?.length === 0) kept.append(NONE[0], NONE[1]);
  for (const tab of tabs ?? []) {
    if (tabs.length > 1) kept.append("tab", tab.name);
    for (const card of tab.cards) keep(kept, card);
  }
  if (at) kept.append("shown", String(at + 1));
  history.replaceState(null, "", `${location.pathname}#${kept}`);
}

/** @param {URLSearchParams} kept @param {import("./cards/card.js").Shown} shown */
function keep(kept, { view, rate, topic, chosenType, fields, settings = {}, wide, tall }) {
  const named = chosenType ? `${topic}:${chosenType}` : topic;
  const chosen = Object.entries(settings).map((each) => `${new URLSearchParams([each])}`); // without a space
  kept.append("card", [view, rate, named, ...fields, ...chosen].join(" "));
  if (wide || tall) kept.append("size", `${wide}x${tall}`);
}
