// SPDX-License-Identifier: Apache-2.0
import { COMMAND_TYPES } from "../shared/command_topic.js";
import { element } from "../shared/dom.js";
import { countOf, replace } from "./name_list.js";

/** The topics of the ROS graph, as a list that can be searched; of those that this page receives with rate, size and age. */
export class TopicList {
  #list;
  #search;
  #gateway;
  #to;
  #items = new Map(); // name -> what stands in the list

  /**
   * @param {HTMLElement} list
   * @param {HTMLInputElement} search
   * @param {import("../shared/gateway.js").Gateway} gateway
   * @param {{open: (topic: string) => void, plot: (topic: string) => void, drive: (topic: string) => void, publish: (topic: string) => void, counted: (words: string) => void}} to
   */
  constructor(list, search, gateway, to) {
    this.#list = list;
    this.#search = search;
    this.#gateway = gateway;
    this.#to = to;
    search.addEventListener("input", () => this.#arrange());
    gateway.on("graph", () => this.#arrange());
  }

  #arrange() {
    const { topics } = this.#gateway.graph;
    const wanted = this.#search.value.trim().toLowerCase();
    const found = [...topics.values()]
      .filter(({ name, types }) => `${name} ${types.join(" ")}`.toLowerCase().includes(wanted))
      .sort((one, other) => one.name.localeCompare(other.name));
    for (const name of this.#items.keys()) if (!topics.has(name)) this.#items.delete(name);
    const reason = topics.size ? `No topic has "${wanted}" in its name or type.` : "There are no topics yet.";
    replace(this.#list, found.map((each) => this.#item(each)), reason);
    this.#to.counted(countOf(found.length, topics.size, "topic"));
    this.#write();
  }

  /** Write what changes with time; called once a second. */
  tick() {
    for (const arrivals of this.#gateway.arrivals.values()) arrivals.tick();
    this.#write();
  }

  #write() {
    for (const { topic, title, figures } of this.#items.values()) {
      const arrivals = this.#gateway.arrivals.get(topic.name);
      title.classList.toggle("stale", !topic.publishers.length || Boolean(arrivals?.isLate));
      figures.textContent = topic.publishers.length ? arrivals?.words ?? "" : "nobody publishes it";
    }
  }

  #item(topic) {
    let item = this.#items.get(topic.name);
    if (!item) {
      const [title, types, figures] = [element("span", {}, topic.name), element("small"), element("small")];
      const button = element("button", { type: "button" }, title, types, figures);
      button.onclick = () => this.#to.open(topic.name);
      const drive = also("drive", `drive by ${topic.name}`, () => this.#to.drive(topic.name));
      const plot = also("plot", `plot a number of ${topic.name}`, () => this.#to.plot(topic.name));
      const publish = also("✎", `publish to ${topic.name}`, () => this.#to.publish(topic.name));
      item = { title, types, figures, drive, element: element("li", {}, button, drive, plot, publish) };
      this.#items.set(topic.name, item);
    }
    item.topic = topic;
    item.types.textContent = topic.types.join(", ");
    item.drive.hidden = !COMMAND_TYPES.includes(topic.types[0]) || !topic.subscribers.length;
    return item.element;
  }
}

/** Make a small button of a topic: what else can be done with it. */
function also(text, words, act) {
  const button = element("button", { type: "button", className: "also", title: words, aria: { label: words } }, text);
  button.onclick = act;
  return button;
}
