// SPDX-License-Identifier: Apache-2.0
// Named layouts: what the address says, kept in this browser, and shared as a link or a file.

import { copy } from "../shared/clipboard.js";
import { open, save } from "../shared/files.js";
import { say } from "../shared/language.js";
import { tell } from "../shared/notice.js";
import { ask } from "../shared/question.js";
import * as page from "./address.js";

const KEY = "ros2-gateway.layouts";
const MOST = 50;
const MOST_BYTES = 64_000; // of a file

/** Return the layouts of this browser, by name. @returns {Record<string, string>} */
function kept() {
  try {
    const found = JSON.parse(localStorage.getItem(KEY) ?? "{}");
    return Object.fromEntries(Object.entries(found).filter(([, text]) => typeof text === "string"));
  } catch {
    return {};
  }
}

/** Keep a layout by its name, or forget it if it is null. */
function keep(name, text) {
  const { [name]: _, ...others } = kept();
  const all = text === null ? others : { ...others, [name]: text };
  if (Object.keys(all).length > MOST) return tell(say("layout.many", { most: MOST }));
  try {
    localStorage.setItem(KEY, JSON.stringify(all));
  } catch ({ message }) {
    tell(say("layout.unkept", { message }));
  }
}

const here = () => location.hash.slice(1);

/** Return the entries of the menu. */
export function entries() {
  const all = kept();
  const names = Object.keys(all).sort((one, other) => one.localeCompare(other));
  const shown = names.find((each) => all[each] === here()) ?? "";
  return [
    ...(names.length ? [{ label: say("layout.kept") }] : []),
    ...names.map((label) => ({ label, isOn: label === shown, act: () => { location.hash = all[label]; } })),
    { label: say("layout.this") },
    { label: say("layout.save"), act: () => saveAs(shown) },
    { label: say("layout.delete"), act: () => keep(shown, null), isOff: !shown },
    { label: say("layout.link"), act: copyLink },
    { label: say("layout.file"), act: () => save(`${shown || "layout"}.json`, JSON.stringify({ name: shown, layout: here() }, null, 2)) },
    { label: say("layout.open"), act: openFile },
  ];
}

async function saveAs(name) {
  const given = await ask(say("layout.name"), name);
  if (given) keep(given, here());
}

async function copyLink() {
  try {
    await copy(location.href);
    tell(say("layout.copied"));
  } catch ({ message }) {
    tell(message);
  }
}

/** Show the layout of a file. Keep it too, if it has a name. */
async function openFile() {
  const file = await open(".json");
  if (!file) return;
  try {
    if (file.size > MOST_BYTES) throw new Error(say("layout.large", { most: MOST_BYTES / 1000 }));
    const { name, layout } = JSON.parse(await file.text());
    if (typeof layout !== "string" || !page.read(layout)) throw new Error(say("layout.empty"));
    if (typeof name === "string" && name) keep(name, layout);
    const words = new URLSearchParams(layout);
    words.delete("token"); // a file must not say who one is
    location.hash = String(words);
  } catch ({ message }) {
    tell(say("layout.invalid", { file: file.name, message }));
  }
}
