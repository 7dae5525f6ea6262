// SPDX-License-Identifier: Apache-2.0
import { COMMAND_TYPES } from "../shared/command_topic.js";
import { breakable, element } from "../shared/dom.js";
import { say } from "../shared/language.js";
import { countOf, mark, replace } from "./name_list.js";
import { treeOf } from "./namespaces.js";
import { rove } from "./roving.js";

const FOLDED = "ros2-gateway.folded";
const MOST_FOLDED = 200;

/** The topics of the ROS graph, by namespace, as a list that can be searched. With rate, size and age as far as these are measured. */
export class TopicList {
  #list;
  #search;
  #gateway;
  #measuring;
  #to;
  #eye; // notes which items can be seen
  #items = new Map(); // name -> what stands in the list
  #branches = new Map(); // namespace -> what stands in the list
  #opened = new Set(); // names that have a card
  #settle;

  /**
   * @param {HTMLElement} list
   * @param {HTMLInputElement} search
   * @param {import("../shared/gateway.js").Gateway} gateway
   * @param {import("./measuring.js").Measuring} measuring
   * @param {{open: (topic: string) => void, plot: (topic: string) => void, drive: (topic: string) => void, publish: (topic: string) => void, allows: (name: string) => boolean, counted: (words: string) => void}} to
   */
  constructor(list, search, gateway, measuring, to) {
    this.#list = list;
    this.#search = search;
    this.#gateway = gateway;
    this.#measuring = measuring;
    this.#to = to;
    this.#settle = rove(list);
    this.#eye = new IntersectionObserver((seen) => {
      for (const { target, isIntersecting } of seen) measuring.see(target.getAttribute("data-topic"), isIntersecting);
    });
    search.addEventListener("input", () => this.#arrange());
    gateway.on("graph", () => this.#arrange());
  }

  #arrange() {
    const { topics } = this.#gateway.graph;
    const wanted = this.#search.value.trim().toLowerCase();
    const found = [...topics.values()]
      .filter(({ name, types }) => this.#to.allows(name) && `${name} ${types.join(" ")}`.toLowerCase().includes(wanted))
      .map(({ name }) => name)
      .sort((one, other) => one.localeCompare(other));
    for (const name of this.#items.keys()) if (!topics.has(name)) this.#remove(name);
    const nodes = wanted ? found.map((name) => ({ name, label: name })) : treeOf(found); // found names are in no closed branch
    const reason = topics.size ? say("list.none.topic", { wanted }) : say("list.no.topic");
    replace(this.#list, nodes.map((each) => this.#place(each)), reason);
    if (!wanted) for (const [namespace, branch] of this.#branches) if (!branch.element.isConnected) this.#branches.delete(namespace);
    this.#settle();
    this.#to.counted(countOf(found.length, topics.size, "topic"));
    this.#write();
  }

  /** Fold all namespaces, or unfold them. */
  fold(isFolded) {
    for (const { details } of this.#branches.values()) details.open = !isFolded;
  }

  /** Mark the topics that have a card. */
  mark(names) {
    this.#opened = names;
    mark(this.#items, names);
  }

  /** Write what changes with time. Called once a second. */
  tick() {
    for (const arrivals of this.#gateway.arrivals.values()) arrivals.tick();
    this.#write();
  }

  #write() {
    for (const { topic, title, figures } of this.#items.values()) {
      const arrivals = this.#measuring.arrivals(topic.name);
      title.element.classList.toggle("stale", !topic.publishers.length || Boolean(arrivals?.isLate));
      const why = this.#misname(topic.name) || (topic.publishers.length ? "" : say("list.unpublished"));
      const words = why || this.#measuring.words(topic.name);
      if (figures.title === words) continue;
      figures.title = words;
      if (why || !arrivals?.messages) figures.replaceChildren(words);
      else figures.replaceChildren(element("span", {}, arrivals.rate || "–"), element("span", {}, arrivals.size));
    }
  }

  /** Return why a topic cannot be opened, if it cannot. */
  #misname({ length }) {
    const most = this.#gateway.hello?.limits.name_characters ?? Infinity;
    return length > most ? say("list.long", { length, most }) : "";
  }

  /** @param {import("./namespaces.js").Node} node */
  #place({ name, label, below }) {
    return below ? this.#branch(name, label, below) : this.#item(name, label);
  }

  #branch(namespace, label, below) {
    if (!this.#branches.has(namespace)) {
      const [title, list] = [titled("summary"), element("ul", { className: "topics" })];
      const details = element("details", { open: !folded().includes(namespace) }, title.element, list);
      details.addEventListener("toggle", () => keepFolded(namespace, !details.open));
      this.#branches.set(namespace, { title, list, details, element: element("li", {}, details) });
    }
    const branch = this.#branches.get(namespace);
    branch.title.say(namespace, label);
    branch.title.element.dataset.count = String(below.length);
    replace(branch.list, below.map((each) => this.#place(each)), "");
    return branch.element;
  }

  #remove(name) {
    this.#eye.unobserve(this.#items.get(name).element);
    this.#measuring.see(name, false);
    this.#items.delete(name);
  }

  #item(name, label) {
    let item = this.#items.get(name);
    if (!item) {
      const [title, types, figures] = [titled("span"), titled("small"), element("small", { className: "figures" })];
      const button = element("button", { type: "button", className: "ghost", aria: { pressed: String(this.#opened.has(name)) } }, title.element, types.element, figures);
      button.onclick = () => this.#to.open(name);
      const drive = also(say("list.drive.short"), say("list.drive", { name }), () => this.#to.drive(name));
      const plot = also(say("list.plot.short"), say("list.plot", { name }), () => this.#to.plot(name));
      const publish = also("✎", say("list.publish", { name }), () => this.#to.publish(name));
      for (const each of [button, drive, plot, publish]) each.disabled = Boolean(this.#misname(name));
      item = { button, title, types, figures, drive, element: element("li", { dataset: { topic: name } }, button, element("span", { className: "actions" }, drive, plot, publish)) };
      this.#items.set(name, item);
      this.#eye.observe(item.element);
    }
    const topic = this.#gateway.graph.topics.get(name);
    item.topic = topic;
    item.title.say(name, label);
    const type = topic.types.join(", ");
    item.types.say(type, type.split("/").at(-1));
    item.button.title = `${name}\n${type}`;
    item.drive.hidden = !COMMAND_TYPES.includes(topic.types[0]) || !topic.subscribers.length;
    return item.element;
  }
}

/** Return the namespaces that are folded in this browser. @returns {string[]} */
function folded() {
  try {
    const kept = JSON.parse(localStorage.getItem(FOLDED) ?? "[]");
    return Array.isArray(kept) ? kept : [];
  } catch {
    return []; // something else has written it
  }
}

/** Keep whether a namespace is folded. The ones that were folded long ago make room. */
function keepFolded(namespace, isFolded) {
  const others = folded().filter((each) => each !== namespace);
  localStorage.setItem(FOLDED, JSON.stringify((isFolded ? [...others, namespace] : others).slice(-MOST_FOLDED)));
}

/** Make an element for a name, of which only the end is seen, its label. All of it is read out. */
function titled(kind) {
  const above = element("span", { className: "unseen" });
  const made = element(kind, { className: "name" }, above);
  const say = (name, label) => {
    if (made.textContent === name && above.textContent.length === name.length - label.length) return;
    above.textContent = name.slice(0, -label.length);
    made.replaceChildren(above, ...breakable(label).childNodes);
  };
  return { element: made, say };
}

/** Make a small button of a topic: what else can be done with it. */
function also(text, words, act) {
  const button = element("button", { type: "button", className: "also ghost", title: words, aria: { label: words } }, text);
  button.onclick = act;
  return button;
}
