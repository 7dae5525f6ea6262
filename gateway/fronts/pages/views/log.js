// SPDX-License-Identifier: Apache-2.0
import { element } from "../shared/dom.js";
import { count, locale, say } from "../shared/language.js";
import { LogLines } from "./log_lines.js";

const LINE = 20; // pixels: all lines are as high, so that only those that are seen are made
const MORE = 5; // lines above and below them
const MOST_NODES = 200; // that can be chosen
const KEPT_TOPIC = "/rosout"; // the gateway keeps its last lines
const LEAST = { all: 0, info: 20, warnings: 30, errors: 40 }; // the least levels that can be chosen
const NAMES = [[50, "fatal"], [40, "error"], [30, "warning"], [20, "info"], [0, "debug"]];

/** `/rosout` as lines, the newest last, by level, node and text. One line is shown as a whole below. */
export class LogView {
  static title = say("view.log");
  static types = ["rcl_interfaces/msg/Log"];

  options = {};
  /** Nobody logs regularly: that nothing comes makes no line old. */
  isIrregular = true;
  rest = 100;
  element = element("div", { className: "log" });
  #card;
  #lines;
  #level;
  #node;
  #search;
  #counts = element("p");
  #reel = element("ul", { role: "listbox", tabIndex: 0 }); // as long as all lines
  #window = element("div", { className: "window" }, this.#reel);
  #none = element("p", { className: "quiet", hidden: true }, say("log.none"));
  #whole = element("p", { className: "whole", role: "status" });
  #chosen = null; // a line
  #drawn = ""; // which lines are there
  #earlier = []; // lines from before, which the gateway has kept

  constructor(card) {
    this.#card = card;
    const { level, node = "", text = "" } = card.settings;
    this.#level = element("select", { aria: { label: say("least.of", { topic: card.topic }) } }, ...Object.keys(LEAST).map((each) => new Option(say(`least.${each}`), each)));
    this.#level.value = level in LEAST ? level : "all";
    this.#node = element("select", { aria: { label: say("log.node", { topic: card.topic }) } }, new Option(say("log.nodes"), ""), ...(node ? [new Option(node)] : []));
    this.#node.value = node;
    this.#search = element("input", { type: "search", placeholder: say("log.text"), value: text, autocomplete: "off", aria: { label: say("log.text.of", { topic: card.topic }) } });
    this.#lines = new LogLines(this.#filter);
    this.#level.onchange = this.#node.onchange = this.#search.oninput = () => this.#choose();
    this.#reel.setAttribute("aria-label", say("log.lines.of", { topic: card.topic }));
    this.#reel.onkeydown = (event) => this.#press(event);
    this.#reel.onclick = ({ target }) => this.#look(Number(target.closest("li")?.dataset.at ?? NaN));
    this.#window.onscroll = () => this.#write();
    this.element.append(element("div", { className: "tools" }, this.#level, this.#node, this.#search), this.#counts, this.#window, this.#none, this.#whole);
    if (card.topic === KEPT_TOPIC) this.#fetch();
  }

  keep(message) {
    this.#lines.add(message);
  }

  show() {
    const { scrollTop, clientHeight, scrollHeight } = this.#window;
    const isAtEnd = scrollTop + clientHeight + LINE >= scrollHeight;
    const gone = this.#lines.take(this.#earlier);
    this.#earlier = [];
    this.#offerNodes();
    this.#fit();
    this.#window.scrollTop = isAtEnd ? this.#window.scrollHeight : Math.max(0, this.#window.scrollTop - gone * LINE);
    this.#write();
  }

  /** Lines from before are shown also if nothing new comes. */
  draw() {
    if (this.#earlier.length) this.show();
  }

  get #filter() {
    return { least: LEAST[this.#level.value], node: this.#node.value, text: this.#search.value };
  }

  async #fetch() {
    try {
      this.#earlier = (await this.#card.gateway.ask({ op: "log" })).lines;
    } catch {
      // the subscription says why
    }
  }

  #choose() {
    this.#card.keep("level", this.#level.value, "all");
    this.#card.keep("node", this.#node.value);
    this.#card.keep("text", this.#search.value);
    this.#lines.filter(this.#filter);
    this.#fit();
    this.#window.scrollTop = this.#window.scrollHeight;
    this.#write();
  }

  #offerNodes() {
    const names = [...this.#lines.nodes].slice(0, MOST_NODES);
    if (names.length + 1 <= this.#node.options.length) return; // a list that is open stays so
    const known = new Set([...this.#node.options].map(({ value }) => value));
    for (const name of names) if (!known.has(name)) this.#node.append(new Option(name));
  }

  /** Make it as long as its lines, and count them. */
  #fit() {
    const { shown, counts } = this.#lines;
    const height = `${shown.length * LINE}px`;
    if (this.#reel.style.height !== height) this.#reel.style.height = height;
    this.#none.hidden = shown.length > 0 || counts.lines === 0;
    this.#window.hidden = shown.length === 0;
    const words = [say("log.lines", { shown: shown.length, all: counts.lines }), count("level.error", counts.errors), count("level.warning", counts.warnings)].join(" · ");
    if (this.#counts.textContent !== words) this.#counts.textContent = words;
  }

  /** Make the lines that are seen. */
  #write() {
    const { shown, first } = this.#lines;
    const { scrollTop, clientHeight } = this.#window;
    const seen = Math.ceil(clientHeight / LINE);
    // lines that a filter takes away leave the place behind the end until the browser scrolls
    const top = Math.min(Math.floor(scrollTop / LINE), shown.length - seen);
    const from = Math.max(0, top - MORE);
    const lines = shown.slice(from, from + seen + 2 * MORE);
    const drawn = `${first} ${from} ${lines.length} ${lines[0]?.at} ${lines.at(-1)?.at}`;
    if (drawn === this.#drawn) return;
    this.#drawn = drawn;
    this.#reel.replaceChildren(...lines.map((each, index) => this.#row(each, from + index)));
    this.#mark();
  }

  #row({ level, stamp, name, msg }, at) {
    const row = element("li", { role: "option", id: `line-${at}`, dataset: { at, level: nameOf(level) } }, `${timeOf(stamp)} `, element("bdi", {}, name), ": ", element("bdi", {}, msg.split("\n", 1)[0])); // a name turns no text around it
    row.style.top = `${at * LINE}px`;
    return row;
  }

  #press(event) {
    const { shown } = this.#lines;
    const at = shown.indexOf(this.#chosen);
    const page = Math.max(1, Math.floor(this.#window.clientHeight / LINE) - 1);
    const next = { ArrowDown: at + 1, ArrowUp: at < 0 ? shown.length - 1 : at - 1, PageDown: at + page, PageUp: at - page, Home: 0, End: shown.length - 1 }[event.key];
    if (next === undefined) return;
    event.preventDefault();
    this.#look(Math.max(0, Math.min(shown.length - 1, next)));
  }

  /** Show a line as a whole. */
  #look(at) {
    const line = this.#lines.shown[at];
    if (!line) return;
    this.#chosen = line;
    const { level, stamp, name, msg, file, function: its, line: number } = line;
    const where = file ? ` (${say("log.where", { place: [file, its].filter(Boolean).join(", "), number })})` : "";
    this.#whole.replaceChildren(`${timeOf(stamp)} ${say(`level.${nameOf(level)}`)} `, element("bdi", {}, name), ": ", element("bdi", {}, msg), where);
    const top = at * LINE;
    const { scrollTop, clientHeight } = this.#window;
    if (top < scrollTop) this.#window.scrollTop = top;
    else if (top + LINE > scrollTop + clientHeight) this.#window.scrollTop = top + LINE - clientHeight;
    this.#drawn = "";
    this.#write();
  }

  #mark() {
    const at = this.#lines.shown.indexOf(this.#chosen);
    for (const row of this.#reel.children) row.setAttribute("aria-selected", String(Number(row.dataset.at) === at));
    if (at < 0) this.#reel.removeAttribute("aria-activedescendant");
    else this.#reel.setAttribute("aria-activedescendant", `line-${at}`);
  }
}

const nameOf = (level) => NAMES.find(([least]) => level >= least)?.[1] ?? "debug";

const timeOf = ({ sec = 0, nanosec = 0 }) => `${new Date(sec * 1000).toLocaleTimeString(locale)}.${String(Math.floor(nanosec / 1e6)).padStart(3, "0")}`;
