// SPDX-License-Identifier: Apache-2.0
import { element } from "../../shared/dom.js";
import { json } from "../../shared/json.js";
import { valueOf } from "../forms/typed.js";
import { Card } from "./card.js";

/** A node: what it publishes, hears and provides, and its parameters, which can be set. */
export class NodeCard extends Card {
  #links = element("div", { className: "group" });
  #parameters = element("div", { className: "form" });
  #ignore = () => {};

  constructor(gateway, shown, actions) {
    super(gateway, shown, actions, { label: `node ${shown.topic}`, title: `Node ${shown.topic}` });
    const again = element("button", { type: "button", title: "ask for the parameters again", aria: { label: `Reload ${shown.topic}` } }, "Reload");
    again.onclick = () => this.#load();
    this.controls.append(again);
    this.body.append(this.#links, element("h4", {}, "Parameters"), this.#parameters);
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
    this.#links.replaceChildren(...Object.entries(lists).map(([title, [names, view]]) => this.#list(title, names, view)));
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
    this.tell("");
    const node = this.topic;
    try {
      const [{ values }, { parameters }] = await Promise.all([
        this.gateway.ask({ op: "get_parameters", node }),
        this.gateway.ask({ op: "describe_parameters", node }),
      ]);
      const names = Object.keys(values).sort();
      this.#parameters.replaceChildren(...names.map((name) => this.#parameter(name, values[name], parameters[name] ?? {})));
      this.actions.grown(this);
      this.footer.textContent = names.length ? `${names.length} parameters` : "it has no parameters";
    } catch (error) {
      this.tell(error.message);
    }
  }

  #parameter(name, value, { type = "", description = "", read_only: isFixed = false, range }) {
    const input = type === "bool"
      ? element("input", { type: "checkbox", checked: value, disabled: isFixed })
      : element("input", { type: "text", value: type === "string" ? value : json(value), readOnly: isFixed, autocomplete: "off", spellcheck: false });
    const text = () => (type === "bool" ? String(input.checked) : type === "string" ? JSON.stringify(input.value) : input.value);
    const problem = element("small", { className: "problem", role: "alert" });
    const about = [type, range ? `${range.from} to ${range.to}` : "", isFixed ? "read-only" : ""].filter(Boolean).join(", ");
    input.onchange = async () => {
      const isSet = await this.#set(name, text(), problem);
      if (type === "bool" && !isSet) input.checked = !input.checked; // it shows what the node has
    };
    return element("label", { className: "value" }, element("span", { title: description }, name, element("small", {}, ` ${about}`)), input, problem);
  }

  /** Set a parameter to a JSON text, and return whether the node has it now. */
  async #set(name, text, problem) {
    problem.textContent = "";
    try {
      valueOf(text);
    } catch (error) {
      problem.textContent = error.cause ? "expected a JSON value, such as true, 0.5 or [1, 2]" : error.message;
      return false;
    }
    try {
      const { results } = await this.gateway.ask({ op: "set_parameters", node: this.topic }, { values: `{${JSON.stringify(name)}:${text}}` });
      problem.textContent = results[name].successful ? "" : results[name].reason;
      this.footer.textContent = results[name].successful ? `${name} is set` : "";
      return results[name].successful;
    } catch (error) {
      problem.textContent = error.message;
      return false;
    }
  }
}
