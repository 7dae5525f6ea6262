// SPDX-License-Identifier: Apache-2.0
// The menu of every page: what it looks like, its language, and its keys.

import { showDialog } from "./dialog.js";
import { element } from "./dom.js";
import { areCharactersOn, isTaken, useCharacters } from "./keys.js";
import { chosen, choose, language, LANGUAGES, say } from "./language.js";
import { menu } from "./menu.js";

const THEMES = ["system", "dark", "light"];

/**
 * Return the menu and the dialog of the keys, which ? also opens.
 * @param {import("./menu.js").Entry[]} more entries of this page
 * @param {[string, string][]} keys of this page, each with what it does
 */
export function pageMenu(more, keys) {
  const dialog = keysDialog(keys);
  const entries = () => [
    ...more,
    { label: say("menu.keys"), key: "?", act: () => showDialog(dialog) },
    { label: say("menu.characters"), isOn: areCharactersOn(), isSwitch: true, act: () => useCharacters(!areCharactersOn()) },
    { label: say("menu.theme") },
    ...THEMES.map((theme) => ({ label: say(`theme.${theme}`), isOn: chosenTheme() === theme, act: () => chooseTheme(theme) })),
    { label: say("menu.language") },
    { label: say("language.browser"), isOn: !chosen, act: () => choose("") },
    ...Object.entries(LANGUAGES).map(([each, label]) => ({ label, isOn: chosen === each, act: () => choose(each) })),
  ];
  addEventListener("keydown", (event) => {
    if (event.key !== "?" || isTaken(event) || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    showDialog(dialog);
  });
  return { menu: menu(say("menu.more"), entries), dialog };
}

const chosenTheme = () => localStorage.getItem("ros2-gateway.theme") ?? "system";

/** Tell theme.js, which keeps it. */
const chooseTheme = (detail) => document.dispatchEvent(new CustomEvent("choosetheme", { detail }));

function keysDialog(keys) {
  const rows = keys.map(([key, words]) => element("div", {}, element("dt", {}, ...key.split(" ").map((each) => element("kbd", {}, each))), element("dd", {}, words)));
  const dialog = element(
    "dialog", { id: "keys", className: "keys", aria: { label: say("menu.keys") } },
    element("form", { method: "dialog" }, element("h2", {}, say("menu.keys")), element("dl", { className: "pairs" }, ...rows), element("button", { type: "submit" }, say("close"))),
  );
  dialog.lang = language;
  return dialog;
}
