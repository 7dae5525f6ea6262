// SPDX-License-Identifier: Apache-2.0
// The texts of the pages, in the language that the user chose, or else the browser prefers. Each language is one file in words/.

import en from "../words/en.js";
import fi from "../words/fi.js";
import { worded } from "./worded.js";

const KEY = "ros2-gateway.language";

/** The name of each language in itself. @type {Record<string, string>} */
export const LANGUAGES = { en: "English", fi: "Suomi" };
/** @type {Record<string, Record<string, string>>} */
const WORDS = { en, fi };

const kept = localStorage.getItem(KEY) ?? "";

/** The language that the user chose, or "" for that of the browser. */
export const chosen = Object.hasOwn(LANGUAGES, kept) ? kept : "";

/** The language of this page. */
export const language = chosen || navigator.languages.map((each) => each.split("-")[0]).find((each) => Object.hasOwn(LANGUAGES, each)) || "en";

/** The way in which times are written: the language, of the country that the browser says if it says one. */
export const locale = navigator.languages.find((each) => each.split("-")[0] === language) ?? language;

const words = WORDS[language];
const plural = new Intl.PluralRules(language);
document.documentElement.lang = language;

/** Take another language, or that of the browser, and load the page again. */
export function choose(other) {
  if (other) localStorage.setItem(KEY, other);
  else localStorage.removeItem(KEY);
  location.reload();
}

/**
 * Return a text.
 * @param {string} key
 * @param {Record<string, string|number>} [values] of what stands in braces
 */
export const say = (key, values = {}) => worded(words, key, values);

/** Return a number of something in words, such as "1 topic" or "2 topics". */
export const count = (key, number) => say(`${key}.${plural.select(number) === "one" ? "one" : "other"}`, { count: number });

/** Fill what the markup of a page leaves to its language: the text, the label and the hint of an element. */
export function fill() {
  for (const each of document.querySelectorAll("[data-say]")) each.textContent = say(each.getAttribute("data-say"));
  for (const each of document.querySelectorAll("[data-say-label]")) each.setAttribute("aria-label", say(each.getAttribute("data-say-label")));
  for (const each of document.querySelectorAll("[data-say-title]")) each.setAttribute("title", say(each.getAttribute("data-say-title")));
  for (const each of document.querySelectorAll("[data-say-hint]")) each.setAttribute("placeholder", say(each.getAttribute("data-say-hint")));
}
