// SPDX-License-Identifier: Apache-2.0
import { span } from "../shared/dom.js";
import { say } from "../shared/language.js";

const ONCE_MS = 2000; // after which no second message is expected

/** Return rate, size and age of what arrived in words. @param {import("../shared/arrivals.js").Arrivals} arrivals */
export function wordsOf({ messages, ageMs, rate, size, dropped }) {
  if (!messages) return say("arrivals.none");
  const once = messages === 1 && ageMs > ONCE_MS && say("arrivals.once");
  return [once, rate, size, say("arrivals.age", { age: span(ageMs) }), dropped && say("arrivals.dropped", { count: dropped })].filter(Boolean).join(" · ");
}
