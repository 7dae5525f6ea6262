// SPDX-License-Identifier: Apache-2.0
import { COMMAND_TYPES } from "../shared/command_topic.js";
import { breakable, element } from "../shared/dom.js";
import { countOf, mark, replace } from "./name_list.js";
import { treeOf } from "./namespaces.js";
import { rove } from "./roving.js";

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
   * @param {{open: (topic: string) => void, plot: (topic: string) => void, drive: (topic: string) => void, publish: (topic: string) => void, counted: (words: string) => void}} to
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
      .filter(({ name, types }) => `${name} ${types.join(" ")}`.toLowerCase().includes(wanted))
      .map(({ name }) => name)
      .sort((one, other) => one.localeCompare(other));
    for (const name of this.#items.keys()) if (!topics.has(name)) this.#remove(name);
    const nodes = wanted ? found.map((name) => ({ name, label: name })) : treeOf(found); // found names are in no closed branch
    const reason = topics.size ? `No topic has "${wanted}" in its name or type.` : "There are no topics yet.";
    replace(this.#list, nodes.map((each) => this.#place(each)), reason);
    if (!wanted) for (const [namespace, branch] of this.#branches) if (!branch.element.isConnected) this.#branches.delete(namespace);
    this.#settle();
    this.#to.counted(countOf(found.length, topics.size, "topic"));
    this.#write();
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
      const isLate = Boolean(this.#measuring.arrivals(topic.name)?.isLate);
      title.element.classList.toggle("stale", !topic.publishers.length || isLate);
      figures.textContent = this.#misname(topic.name) || (topic.publishers.length ? this.#measuring.words(topic.name) : "no node publishes it");
    }
  }

  /** Return why a topic cannot be opened, if it cannot. */
  #misname({ length }) {
    const most = this.#gateway.hello?.limits.name_characters ?? Infinity;
    return length > most ? `its name has ${length} characters, the gateway accepts ${most}` : "";
  }

  /** @param {import("./namespaces.js").Node} node */
  #place({ name, label, below }) {
    return below ? this.#branch(name, label, below) : this.#item(name, label);
  }

  #branch(namespace, label, below) {
    if (!this.#branches.has(namespace)) {
      const [title, list] = [titled("summary"), element("ul", { className: "topics" })];
      this.#branches.set(namespace, { title, list, element: element("li", {}, element("details", { open: true }, title.element, list)) });
    }
    const branch = this.#branches.get(namespace);
    branch.title.say(namespace, label);
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
      const [title, types, figures] = [titled("span"), element("small"), element("small")];
      const button = element("button", { type: "button", aria: { pressed: String(this.#opened.has(name)) } }, title.element, types, figures);
      button.onclick = () => this.#to.open(name);
      const drive = also("drive", `drive by ${name}`, () => this.#to.drive(name));
      const plot = also("plot", `plot a number of ${name}`, () => this.#to.plot(name));
      const publish = also("✎", `publish to ${name}`, () => this.#to.publish(name));
      for (const each of [button, drive, plot, publish]) each.disabled = Boolean(this.#misname(name));
      item = { button, title, types, figures, drive, element: element("li", { dataset: { topic: name } }, button, drive, plot, publish) };
      this.#items.set(name, item);
      this.#eye.observe(item.element);
    }
    const topic = this.#gateway.graph.topics.get(name);
    item.topic = topic;
    item.title.say(name, label);
    item.types.replaceChildren(breakable(topic.types.join(", ")));
    item.drive.hidden = !COMMAND_TYPES.includes(topic.types[0]) || !topic.subscribers.length;
    return item.element;
  }
}

/** Make an element for a name, of which only the end is seen, its label. All of it is read out. */
function titled(kind) {
  const above = element("span", { className: "unseen" });
  const made = element(kind, {}, above);
  const say = (name, label) => {
    if (made.textContent === name && above.textContent.length === name.length - label.length) return;
    above.textContent = name.slice(0, -label.length);
    made.replaceChildren(above, ...breakable(label).childNodes);
  };
  return { element: made, say };
}

/** Make a small button of a topic: what else can be done with it. */
function also(text, words, act) {
  const button = element("button", { type: "button", className: "also", title: words, aria: { label: words } }, text);
  button.onclick = act;
  return button;
}
