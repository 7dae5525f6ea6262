// SPDX-License-Identifier: Apache-2.0
// On a phone the pages are at the bottom of the screen, within a thumb's reach. There the list of topics also has a link.

import { element, find } from "./dom.js";
import { say } from "./language.js";

const KEY = "ros2-gateway.show"; // of the tab's storage: what the debug page brings into view at first
const TOPICS = "topics";

/**
 * Return the link to the list of topics, which only phones show.
 * @param {string} debug the path of the debug page, which has it
 * @param {string} here which page this is
 */
export function topicsLink(debug, here) {
  const link = element("a", { className: "of-phone", href: debug }, say("page.topics"));
  link.onclick = (event) => {
    if (here !== "debug") return sessionStorage.setItem(KEY, TOPICS);
    event.preventDefault();
    show();
  };
  return link;
}

/** Return the name of the debug page. On a phone its cards and its topics have a link each. */
export const debugName = () => [element("span", { className: "of-desk" }, say("page.debug")), element("span", { className: "of-phone" }, say("page.cards"))];

/** Bring into view what was asked for on another page, and let the links tell what is seen. */
export function goOn(here) {
  if (here === "debug") follow();
  if (here !== "debug" || sessionStorage.getItem(KEY) !== TOPICS) return;
  sessionStorage.removeItem(KEY);
  show();
}

/** Mark one of the two links to the debug page as current: to the list while it is in the middle of the screen, or else to the cards. */
function follow() {
  /** @type {NodeListOf<HTMLAnchorElement>} */
  const links = document.querySelectorAll(".pages a");
  const [cards, topics] = links;
  const phone = matchMedia("(max-width: 45rem)"); // as style.css has it
  let isListSeen = false;
  const mark = () => {
    const [current, other] = phone.matches && isListSeen ? [topics, cards] : [cards, topics];
    current.setAttribute("aria-current", "page");
    other.removeAttribute("aria-current");
  };
  phone.onchange = mark;
  cards.onclick = (event) => {
    if (!phone.matches) return;
    event.preventDefault(); // the cards are in the address, and the link has none
    scrollTo(0, 0);
  };
  const observer = new IntersectionObserver((entries) => {
    isListSeen = entries.at(-1).isIntersecting;
    mark();
  }, { rootMargin: "-50% 0px" });
  observer.observe(find("tab-topics").closest("nav"));
}

/** Bring the list into view, and keep it there while cards above it grow with their first messages, until the user does something. */
function show() {
  const list = find("tab-topics").closest("nav");
  find("tab-topics").focus({ preventScroll: true });
  const growth = new ResizeObserver(() => list.scrollIntoView());
  growth.observe(document.body);
  for (const act of ["pointerdown", "wheel", "keydown"]) addEventListener(act, () => growth.disconnect(), { once: true });
}
