// SPDX-License-Identifier: Apache-2.0
import { element } from "../../shared/dom.js";
import { say } from "../../shared/language.js";
import { Parameters } from "../parameters/parameters.js";
import { Card } from "./card.js";

/** A node: what it publishes, hears and provides, and its parameters, which can be set. */
export class NodeCard extends Card {
  #links = element("div", { className: "group" });
  #parameters;
  #ignore = () => {};

  constructor(gateway, shown, actions) {
    super(gateway, shown, actions, { title: say("node.title", { name: shown.topic }) });
    const again = element("button", { type: "button", title: say("node.reload.about"), aria: { label: `${say("node.reload")} ${shown.topic}` } }, say("node.reload"));
    again.onclick = () => this.#load();
    this.#parameters = new Parameters(gateway, shown.topic, { tell: (problem) => this.tell(problem), said: (words) => (this.footer.textContent = words) });
    this.controls.append(again);
    this.body.append(this.#links, element("h4", {}, say("parameters")), this.#parameters.element);
    this.#ignore = gateway.on("graph", () => this.#writeLinks());
    this.#writeLinks();
    this.#load();
  }

  close() {
    this.#ignore();
    super.close();
  }

  #writeLinks() {
    const { topics, services, actions } = this.gateway.graph;
    const node = this.topic;
    const named = (entries, has) => [...entries.values()].filter(has).map(({ name }) => name).sort();
    const lists = {
      publishes: [named(topics, (each) => each.publishers.includes(node)), undefined],
      subscribes: [named(topics, (each) => each.subscribers.includes(node)), undefined],
      services: [named(services, (each) => each.nodes.includes(node)), "call"],
      actions: [named(actions, (each) => each.nodes.includes(node)), "goal"],
    };
    this.#links.replaceChildren(...Object.entries(lists).map(([kind, [names, view]]) => this.#list(say(`node.${kind}`), names, view)));
  }

  #list(title, names, view) {
    const items = names.map((name) => {
      const button = element("button", { type: "button" }, name);
      button.onclick = () => this.actions.open(name, view);
      return element("li", {}, button);
    });
    return element("details", {}, element("summary", {}, `${title} (${names.length})`), element("ul", { className: "topics" }, ...items));
  }

  async #load() {
    await this.#parameters.fetch();
    this.actions.grown(this);
  }
}
