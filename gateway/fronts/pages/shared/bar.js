// SPDX-License-Identifier: Apache-2.0
// The top of every page: the other pages, the connection in words, the token dialog, and STOP.

import { isOver, refusal } from "./control_words.js";
import { element, find } from "./dom.js";
import { notice, review, tell } from "./notice.js";
import { stopButton } from "./stop.js";

export { review, tell, untell } from "./notice.js";
export { stopBySpace } from "./stop.js";

const PAGES = { Debug: "/", Drive: "/drive", Lab: "/lab" };
const WORDS = {
  open: () => "connected",
  connecting: () => "connecting",
  silent: (seconds) => `no answer for ${seconds} s`,
  closed: (reason) => `not connected${reason ? `: ${reason}` : ""}; trying again`,
  token: () => "enter a token",
};

/**
 * Put the bar at the top of a page and connect it with its gateway.
 * @param {import("./gateway.js").Gateway} gateway
 * @param {string} here the name of the page
 * @param {...Node} more elements between the connection and STOP
 */
export function connect(gateway, here, ...more) {
  const skip = document.querySelector(".skip"); // the first stop of Tab, if a page has one
  document.body.prepend(...(skip ? [skip] : []), header(gateway, here, more), notice());
  document.body.append(tokenDialog(gateway));
  const top = document.querySelector(".bar");
  new ResizeObserver(() => document.documentElement.style.setProperty("--bar", `${top.getBoundingClientRect().height}px`)).observe(top);
  let before = "";
  const say = (state, detail) => {
    find("state").textContent = WORDS[state](detail);
    find("state").dataset.state = state;
  };
  gateway.on("silence", (seconds) => (seconds ? say("silent", seconds) : say(before, "")));
  gateway.on("state", ({ state, reason }) => {
    say(state, reason);
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
    element("a", { href: path, aria: name === here ? { current: "page" } : {} }, name)
  ));
  return element(
    "header", { className: "bar" },
    element("h1", {}, "ROS 2 gateway"),
    element("nav", { className: "pages", aria: { label: "Pages" } }, ...links),
    element("p", { id: "state", className: "state", role: "status" }, "connecting"),
    element("button", { id: "ask-token", type: "button", hidden: true, onclick: () => ask("") }, "Enter a token"),
    ...more,
    stopButton(gateway),
  );
}

function ask(problem) {
  find("token-problem").textContent = problem;
  find("token").returnValue = ""; // also after Escape
  find("token").showModal();
}

function tokenDialog(gateway) {
  const token = element("input", { id: "token-text", type: "password", autocomplete: "off", required: true });
  const dialog = element(
    "dialog", { id: "token" },
    element(
      "form", { method: "dialog" },
      element("h2", {}, "This gateway needs a token"),
      element("p", {}, element("code", {}, "ros2-gateway token create NAME"), " makes one. This page keeps it until you close the tab."),
      element("label", {}, "Token ", token),
      element("p", { id: "token-problem", role: "alert" }),
      element("button", { type: "submit", value: "connect" }, "Connect"),
    ),
  );
  dialog.onclose = () => dialog.returnValue && gateway.useToken(token.value);
  return dialog;
}
