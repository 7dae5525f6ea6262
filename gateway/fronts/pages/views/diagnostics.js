// SPDX-License-Identifier: Apache-2.0
import { element } from "../shared/dom.js";
import { count, locale, say } from "../shared/language.js";
import { Pairs } from "./pairs.js";

const LEVELS = ["ok", "warning", "error", "stale"]; // DiagnosticStatus.OK, WARN, ERROR and STALE
const LEAST = { all: 0, warnings: 1, errors: 2 }; // the least level of the shown parts
const STALE = 3;
const STALE_MS = 5000; // as diagnostic_aggregator has it
const MOST_STATUSES = 1000;
const DEEPEST = 8; // groups above a part: what is below has one name
const MOST_CHANGES = 20; // of each status
const MOST_VALUES = 200; // of each status

/** The status of each part, as a tree by the slashes in its name, with its values and its last changes. */
export class DiagnosticsView {
  static title = say("view.diagnostics");
  static types = ["diagnostic_msgs/msg/DiagnosticArray"];

  options = {};
  rest = 250;
  element = element("div", { className: "diagnostics" });
  #card;
  #statuses = new Map(); // name -> Status
  #groups = new Map(); // path -> the place of what is below it
  #counts = element("p", { className: "counts" });
  #none = element("p", { className: "quiet", hidden: true });
  #tree = element("div");
  #level;
  #lookedMs = 0;
  #hasLeftOut = false;

  constructor(card) {
    this.#card = card;
    this.#level = element("select", { aria: { label: say("least.of", { topic: card.topic }) } }, ...Object.keys(LEAST).map((each) => new Option(say(`least.${each}`), each)));
    this.#level.value = card.settings.level in LEAST ? card.settings.level : "all";
    this.#level.onchange = () => {
      card.keep("level", this.#level.value, "all");
      this.#write();
    };
    this.element.append(element("div", { className: "tools" }, this.#level, this.#counts), this.#tree, this.#none);
  }

  keep({ status }) {
    for (const each of status) {
      const known = this.#statuses.get(each.name);
      if (!known && this.#statuses.size >= MOST_STATUSES) this.#forget();
      (known ?? this.#add(each.name)).take(each);
    }
  }

  show() {
    this.#write();
  }

  /** A part that says nothing more becomes stale while nothing comes. */
  draw() {
    if (performance.now() - this.#lookedMs > 1000) this.#write();
  }

  /** A part was not silent for as long as nobody listened. */
  wake() {
    for (const each of this.#statuses.values()) each.heardMs = performance.now();
  }

  #write() {
    this.#lookedMs = performance.now();
    const counts = [0, 0, 0, 0];
    const least = LEAST[this.#level.value];
    let shown = 0;
    for (const each of this.#statuses.values()) {
      counts[each.level] += 1;
      each.element.hidden = each.level < least;
      shown += Number(!each.element.hidden);
      each.write();
    }
    for (const group of this.#groups.values()) group.hidden = ![...group.querySelectorAll(".status")].some((each) => !each.hidden);
    const leftOut = this.#hasLeftOut ? ` · ${say("diagnostics.many", { most: MOST_STATUSES })}` : "";
    const words = LEVELS.map((word, level) => count(`level.${word}`, counts[level])).reverse().join(" · ") + leftOut;
    if (this.#counts.textContent !== words) this.#counts.textContent = words;
    this.#none.hidden = shown > 0;
    this.#none.textContent = this.#statuses.size ? say("diagnostics.none.level", { count: this.#statuses.size }) : say("diagnostics.none");
  }

  #add(name) {
    const { groups, own } = partsOf(name);
    const made = new Status(own);
    this.#statuses.set(name, made);
    this.#place(groups).append(made.element);
    return made;
  }

  /** Return the place of what is below some names. */
  #place(names) {
    if (!names.length) return this.#tree;
    const path = names.join("/");
    let group = this.#groups.get(path);
    if (!group) {
      group = element("details", { open: true }, element("summary", {}, element("bdi", {}, names.at(-1))));
      this.#groups.set(path, group);
      this.#place(names.slice(0, -1)).append(group);
    }
    return group;
  }

  /** Leave out the part that has said nothing for the longest time, and groups that are empty then. */
  #forget() {
    this.#hasLeftOut = true;
    const [name, oldest] = [...this.#statuses].reduce((one, other) => (other[1].heardMs < one[1].heardMs ? other : one));
    this.#statuses.delete(name);
    oldest.element.remove();
    const { groups } = partsOf(name);
    for (; groups.length; groups.pop()) {
      const path = groups.join("/");
      const group = this.#groups.get(path);
      if (group.querySelector(".status")) return;
      group.remove();
      this.#groups.delete(path);
    }
  }
}

/** Return the names of the groups of a part, and its own. */
function partsOf(name) {
  const parts = name.split("/").filter(Boolean);
  const groups = parts.slice(0, -1).slice(0, DEEPEST);
  return { groups, own: parts.slice(groups.length).join("/") || name };
}

/** One part: its level and message, its values, and what has changed. */
class Status {
  heardMs = 0;
  element = element("details", { className: "status" });
  #level = element("strong", { className: "level" });
  #message = element("bdi");
  #values = new Pairs();
  #changes = element("ol", { className: "changes" });
  #newest = null;
  #isNew = false; // whether it is not written yet
  #said = "";

  constructor(name) {
    const summary = element("summary", {}, this.#level, " ", element("bdi", {}, name), ": ", this.#message);
    this.element.append(summary, this.#values.element, element("h4", {}, say("diagnostics.changes")), this.#changes);
    this.element.ontoggle = () => this.#writeValues();
  }

  /** Its level now. */
  get level() {
    return performance.now() - this.heardMs > STALE_MS ? STALE : Math.min(Number(this.#newest.level), STALE);
  }

  take(status) {
    this.heardMs = performance.now();
    this.#newest = status;
    this.#isNew = true;
    this.#note(`${say(`level.${LEVELS[this.level]}`)}: ${status.message}`);
  }

  write() {
    const level = LEVELS[this.level];
    if (this.#level.dataset.level !== level) {
      this.#level.dataset.level = level;
      this.#level.textContent = say(`level.${level}`);
    }
    if (level === "stale") this.#note(say("diagnostics.stale", { seconds: STALE_MS / 1000 }));
    if (!this.#isNew) return;
    this.#isNew = false;
    if (this.#message.textContent !== this.#newest.message) this.#message.textContent = this.#newest.message;
    this.#writeValues();
  }

  #writeValues() {
    if (!this.element.open || !this.#newest) return;
    const { hardware_id: hardware, values } = this.#newest;
    const pairs = values.slice(0, MOST_VALUES).map(({ key, value }) => [key, value]);
    const leftOut = values.length > MOST_VALUES ? [[say("diagnostics.left"), say("diagnostics.values", { count: values.length - MOST_VALUES })]] : [];
    this.#values.show([...(hardware ? [[say("diagnostics.hardware"), hardware]] : []), ...pairs, ...leftOut]);
  }

  #note(words) {
    if (words === this.#said) return;
    this.#said = words;
    this.#changes.prepend(element("li", {}, `${new Date().toLocaleTimeString(locale)} `, element("bdi", {}, words)));
    if (this.#changes.childElementCount > MOST_CHANGES) this.#changes.lastElementChild.remove();
  }
}
