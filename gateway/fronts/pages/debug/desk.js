// SPDX-License-Identifier: Apache-2.0
import { element } from "../shared/dom.js";
import { say } from "../shared/language.js";
import { ask } from "../shared/question.js";
import { makeCard } from "./cards/cards.js";

export const MOST_TABS = 20;
const LONGEST_NAME = 40; // characters

/** A tab with its cards. @typedef {{name: string, cards: import("./cards/card.js").Card[]}} Tab */

/** The cards of the page, in one or several tabs. Cards that nobody sees ask for nothing, but their goals go on. */
export class Desk {
  /** @type {Tab[]} */
  tabs = [{ name: "", cards: [] }];
  /** The tab that is shown. */
  tab = this.tabs[0];
  /** The card that has the whole page. @type {import("./cards/card.js").Card|null} */
  #whole = null;
  #place;
  #strip;
  #gateway;
  #actions;

  /**
   * @param {HTMLElement} place of the cards
   * @param {HTMLElement} strip of the tabs, which hides while there is only one
   * @param {import("../shared/gateway.js").Gateway} gateway
   * @param {{changed: () => void, open: (name: string, view?: string, fields?: string[]) => void, grown: (card: import("./cards/card.js").Card) => void, left: (card?: import("./cards/card.js").Card) => void}} to the page.
   *   `left` gets the card that the focus goes to from one that is closed
   */
  constructor(place, strip, gateway, to) {
    this.#place = place;
    this.#strip = strip;
    this.#gateway = gateway;
    this.#actions = {
      ...to,
      close: (card) => this.#close(card, to.left),
      move: (card, where) => this.move(card, where),
      maximise: (card, isOnScreen) => {
        to.changed(); // cards that come by themselves would restore it
        this.maximise(card, isOnScreen);
      },
      tabs: (card) => this.#entries(card),
    };
    addEventListener("keydown", (event) => {
      if (event.key === "Escape" && !event.defaultPrevented && !document.querySelector("dialog[open], :popover-open")) this.maximise(null);
    });
    document.addEventListener("fullscreenchange", () => document.fullscreenElement ?? this.maximise(null));
    document.addEventListener("visibilitychange", () => this.#settle());
    strip.addEventListener("keydown", (event) => this.#step(event));
  }

  /** All cards, of all tabs. */
  get cards() {
    return this.tabs.flatMap(({ cards }) => cards);
  }

  /** Make a card in the tab that is shown. */
  add(shown) {
    this.maximise(null);
    const card = makeCard(this.#gateway, shown, this.#actions);
    this.tab.cards.push(card);
    this.#place.append(card.element);
    this.#settle();
    return card;
  }

  /** Let the cards that nobody sees rest, and the others go on. */
  #settle() {
    for (const tab of this.tabs) {
      for (const card of tab.cards) {
        const isUnseen = tab !== this.tab || (document.hidden && !card.isCollecting);
        if (isUnseen === card.isResting) continue;
        if (isUnseen) card.rest();
        else card.wake();
      }
    }
  }

  /** Show the tab that has a card. */
  find(card) {
    this.show(this.tabs.find(({ cards }) => cards.includes(card)) ?? this.tab);
    if (!card.element.checkVisibility()) this.maximise(null); // another one hides it
  }

  #close(card, left) {
    const { cards } = this.tab;
    const index = cards.indexOf(card);
    const hadFocus = card.element.contains(document.activeElement);
    if (card.isFull) this.maximise(null);
    card.close();
    cards.splice(index, 1);
    this.#actions.changed();
    if (hadFocus) left(cards[Math.min(index, cards.length - 1)]);
  }

  /** Move a card before another one, to the end, or by some places. */
  move(card, where) {
    const { cards } = this.tab;
    const from = cards.indexOf(card);
    cards.splice(from, 1);
    let next = typeof where === "number" ? null : where.before;
    while (next && !cards.some((each) => each.element === next)) next = next.nextElementSibling; // itself, or a card of another tab
    const before = cards.findIndex((each) => each.element === next);
    const to = typeof where === "number" ? Math.max(0, Math.min(cards.length, from + where)) : before < 0 ? cards.length : before;
    cards.splice(to, 0, card);
    const had = /** @type {HTMLElement|null} */ (document.activeElement);
    const { scrollTop } = card.body;
    this.#place.insertBefore(card.element, cards[to + 1]?.element ?? null);
    card.body.scrollTop = scrollTop; // it was taken out for a moment
    if (had && card.element.contains(had)) had.focus();
    this.#actions.changed();
  }

  /** Let a card have the page below the bar with STOP, also the screen where the browser can, or give all cards their places again. */
  maximise(card, isOnScreen = false) {
    const before = this.#whole;
    const next = card === before ? null : card;
    if (next === before) return;
    this.#whole = next;
    before?.element.classList.remove("whole");
    next?.element.classList.add("whole");
    document.body.classList.toggle("maximised", Boolean(next));
    (next ?? (card && before))?.element.focus({ preventScroll: true });
    before?.setFull(false);
    next?.setFull(true);
    if (next && isOnScreen) document.documentElement.requestFullscreen?.().catch(() => {}); // a phone may have none: the page is filled all the same
    else if (!next && document.fullscreenElement) document.exitFullscreen();
  }

  /** Open a tab, or show one. */
  show(tab) {
    if (tab === this.tab) return;
    this.maximise(null);
    for (const card of this.tab.cards) card.element.hidden = true;
    this.tab = tab;
    for (const card of tab.cards) card.element.hidden = false;
    this.#settle();
    this.#actions.changed();
  }

  /** Make a tab, and show it. */
  open(name) {
    if (!this.tab.name) this.tab.name = say("tab.numbered", { number: 1 });
    const tab = { name: name.slice(0, LONGEST_NAME), cards: [] };
    this.tabs.push(tab);
    this.show(tab);
  }

  /** Open a tab that the address names. The first one is there. */
  restore(name) {
    if (this.tabs.length === 1 && !this.tab.name && !this.tab.cards.length) this.tab.name = name.slice(0, LONGEST_NAME);
    else this.open(name);
  }

  async #ask() {
    const name = await ask(say("tab.name"), say("tab.numbered", { number: this.tabs.length + 1 }));
    if (name) this.open(name);
  }

  async #rename(tab) {
    const name = await ask(say("tab.name"), tab.name);
    if (!name) return;
    tab.name = name.slice(0, LONGEST_NAME);
    this.#actions.changed();
  }

  /** Close the tab that is shown, with its cards. */
  closeTab() {
    const { tab } = this;
    const at = this.tabs.indexOf(tab);
    this.show(this.tabs[at + 1] ?? this.tabs[at - 1]);
    for (const card of tab.cards) card.close();
    this.tabs.splice(at, 1);
    this.#actions.changed();
  }

  /** Return the entries of a menu about tabs. */
  get entries() {
    const several = this.tabs.length > 1;
    return [
      { label: say("tab.new"), act: () => this.#ask(), isOff: this.tabs.length >= MOST_TABS },
      { label: say("tab.rename"), act: () => this.#rename(this.tab), isOff: !several },
      { label: say("tab.close"), act: () => this.closeTab(), isOff: !several },
    ];
  }

  #entries(card) {
    const others = this.tabs.filter((each) => each !== this.tab);
    return others.map((tab) => ({
      label: say("card.to", { tab: tab.name }),
      act: () => {
        this.tab.cards.splice(this.tab.cards.indexOf(card), 1);
        tab.cards.push(card);
        this.#place.append(card.element);
        this.show(tab);
      },
    }));
  }

  /** Write the tabs. */
  write() {
    this.#strip.hidden = this.tabs.length < 2;
    this.#strip.replaceChildren(...this.tabs.map((tab) => {
      const isShown = tab === this.tab;
      const made = element("button", { type: "button", role: "tab", tabIndex: isShown ? 0 : -1, aria: { selected: String(isShown), controls: "cards" } }, tab.name);
      made.onclick = () => {
        this.show(tab);
        this.#focus();
      };
      made.ondblclick = () => this.#rename(tab);
      return made;
    }));
  }

  #focus() {
    /** @type {HTMLElement|null} */ (this.#strip.querySelector("[aria-selected=true]"))?.focus();
  }

  #step(event) {
    const at = this.tabs.indexOf(this.tab);
    const next = { ArrowRight: this.tabs[at + 1] ?? this.tabs[0], ArrowLeft: this.tabs.at(at - 1), Home: this.tabs[0], End: this.tabs.at(-1) }[event.key];
    if (!next) return;
    event.preventDefault();
    this.show(next);
    this.#focus();
  }
}
