// SPDX-License-Identifier: Apache-2.0
// The top of every page: the other pages, the connection in words, the token dialog, and STOP.

import { BASE } from "./base.js";
import { isOver, refusal } from "./control_words.js";
import { showDialog } from "./dialog.js";
import { element, find } from "./dom.js";
import { fill, say } from "./language.js";
import { notice, review, tell } from "./notice.js";
import { pageMenu } from "./page_menu.js";
import { debugName, goOn, topicsLink } from "./phone.js";
import { playerBar } from "./player.js";
import { recorder } from "./record.js";
import { stopButton } from "./stop.js";

export { review, tell, untell } from "./notice.js";
export { stopBySpace } from "./stop.js";

const PAGES = { debug: `${BASE}/`, drive: `${BASE}/drive`, lab: `${BASE}/lab` };
const WORDS = {
  open: () => say("state.open"),
  connecting: () => say("state.connecting"),
  silent: (seconds) => say("state.silent", { seconds }),
  closed: (why) => (why ? say("state.closed.why", { why }) : say("state.closed")),
  token: () => say("state.token"),
};

/**
 * Put the bar at the top of a page and connect it with its gateway.
 * @param {import("./gateway.js").Gateway} gateway
 * @param {keyof PAGES} here which page it is
 * @param {{figures?: Node[], entries?: import("./menu.js").Entry[], keys?: [string, string][]}} [more] elements next to the connection, entries of the menu, and keys
 */
export function connect(gateway, here, { figures = [], entries = [], keys = [] } = {}) {
  fill();
  const skip = document.querySelector(".skip"); // the first stop of Tab, if a page has one
  const { button, panel } = recorder(gateway);
  const { menu, dialog } = pageMenu(entries, [...keys, ["?", say("keys.help")]]);
  document.body.prepend(...(skip ? [skip] : []), header(gateway, here, [...figures, button, menu]), notice(), playerBar(gateway));
  document.querySelector(".bar").append(panel);
  document.body.append(dialog);
  document.body.append(tokenDialog(gateway));
  goOn(here);
  const top = document.querySelector(".bar");
  new ResizeObserver(() => document.documentElement.style.setProperty("--bar", `${top.getBoundingClientRect().height}px`)).observe(top);
  let before = "";
  const show = (state, detail) => {
    find("state").textContent = WORDS[state](detail);
    find("state").dataset.state = state;
  };
  gateway.on("silence", (seconds) => (seconds ? show("silent", seconds) : show(before, "")));
  gateway.on("state", ({ state, reason }) => {
    show(state, reason);
    find("ask-token").hidden = state !== "token";
    // a notice belongs to the connection before. But one without a connection stays while the page tries again
    if (state === "open" || (state === "closed" && before === "open")) tell("");
    if (state === "token") ask(reason);
    before = state;
  });
  gateway.on("status", (frame) => {
    const words = refusal(frame);
    if (words) tell(words, isOver(frame));
  });
  gateway.on("graph", () => review());
  addEventListener("hashchange", () => location.reload()); // another address was typed or followed
}

function header(gateway, here, more) {
  const links = Object.entries(PAGES).map(([name, path]) => (
    element("a", { href: path, aria: name === here ? { current: "page" } : {} }, ...(name === "debug" ? debugName() : [say(`page.${name}`)]))
  ));
  links.splice(1, 0, topicsLink(PAGES.debug, here));
  return element(
    "header", { className: "bar" },
    element("h1", {}, "ROS 2 gateway"),
    element("nav", { className: "pages", aria: { label: say("pages") } }, ...links),
    element("p", { id: "state", className: "state", role: "status" }, say("state.connecting")),
    element("button", { id: "ask-token", type: "button", hidden: true, onclick: () => ask("") }, say("token.enter")),
    element("div", { className: "bar-tools" }, ...more),
    stopButton(gateway),
  );
}

function ask(problem) {
  find("token-problem").textContent = problem;
  find("token").returnValue = ""; // also after Escape
  showDialog(find("token"));
}

function tokenDialog(gateway) {
  const token = element("input", { id: "token-text", type: "password", autocomplete: "off", required: true });
  const dialog = element(
    "dialog", { id: "token" },
    element(
      "form", { method: "dialog" },
      element("h2", {}, say("token.title")),
      element("p", {}, element("code", {}, "ros2-gateway token create NAME"), say("token.how")),
      element("label", {}, say("token.label"), token),
      element("p", { id: "token-problem", role: "alert" }),
      element("button", { type: "submit", value: "connect" }, say("token.connect")),
    ),
  );
  dialog.onclose = () => dialog.returnValue && gateway.useToken(token.value);
  return dialog;
}
