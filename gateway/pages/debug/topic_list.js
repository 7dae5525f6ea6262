// SPDX-License-Identifier: Apache-2.0
import { element } from "../shared/dom.js";

const GATEWAYS_OWN = /^\/(rosout|parameter_events)$/;

/** The topics of the ROS graph, as a list that can be searched. */
export class TopicList {
  #list;
  #search;
  #open;
  #topics = new Map(); // name -> as the gateway describes it

  /**
   * @param {HTMLElement} list
   * @param {HTMLInputElement} search
   * @param {(topic: string) => void} open
   */
  constructor(list, search, open) {
    this.#list = list;
    this.#search = search;
    this.#open = open;
    search.oninput = () => this.#write();
  }

  /** The types of what robots publish; the log does not count. */
  get published() {
    return [...this.#topics.values()].filter((each) => each.publishers.length && !GATEWAYS_OWN.test(each.name));
  }

  /** Return the type of a topic, or "". */
  typeOf(topic) {
    return this.#topics.get(topic)?.types[0] ?? "";
  }

  /** Take a frame of the operation `graph`: all that there is, or what has changed. */
  update({ topics, changes }) {
    if (topics) this.#topics.clear();
    for (const each of topics ?? changes.topics ?? []) this.#topics.set(each.name, each);
    for (const name of changes?.gone_topics ?? []) this.#topics.delete(name);
    this.#write();
  }

  #write() {
    const wanted = this.#search.value.trim().toLowerCase();
    const found = [...this.#topics.values()]
      .filter(({ name, types }) => `${name} ${types.join(" ")}`.toLowerCase().includes(wanted))
      .sort((one, other) => one.name.localeCompare(other.name));
    this.#list.replaceChildren(...found.map((each) => this.#item(each)));
    if (!found.length) {
      const reason = this.#topics.size ? `No topic has "${wanted}" in its name or type.` : "There are no topics yet.";
      this.#list.append(element("li", { className: "empty" }, reason));
    }
  }

  #item({ name, types, publishers }) {
    const button = element("button", { type: "button" });
    const said = publishers.length ? types.join(", ") : `${types.join(", ")} · nobody publishes it`;
    button.append(element("span", { className: publishers.length ? "" : "stale" }, name), element("small", {}, said));
    button.onclick = () => this.#open(name);
    return element("li", {}, button);
  }
}
