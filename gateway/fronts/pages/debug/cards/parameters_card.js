// SPDX-License-Identifier: Apache-2.0
import { element } from "../../shared/dom.js";
import { count, say } from "../../shared/language.js";
import { Parameters } from "../parameters/parameters.js";
import { Card } from "./card.js";

/** The parameters of all nodes, as a tree by node. A node is asked once it is opened. */
export class ParametersCard extends Card {
  #nodes = new Map(); // name -> its place
  #tree = element("div", { className: "form" });
  #ignore;

  constructor(gateway, shown, actions) {
    super(gateway, shown, actions, { title: say("list.parameters") });
    this.body.append(this.#tree);
    this.#ignore = gateway.on("graph", () => this.#write());
    this.#write();
  }

  close() {
    this.#ignore();
    super.close();
  }

  #write() {
    const { nodes } = this.gateway.graph;
    for (const [name, place] of this.#nodes) {
      if (nodes.has(name)) continue;
      place.remove();
      this.#nodes.delete(name);
    }
    for (const name of [...nodes].sort()) if (!this.#nodes.has(name) && !name.includes("/_")) this.#add(name);
    this.footer.textContent = count("list.node", this.#nodes.size);
  }

  #add(name) {
    const said = element("p", { className: "quiet", role: "status" });
    const problem = element("p", { className: "problem", role: "status" });
    const place = element("details", {}, element("summary", {}, name));
    let parameters = null;
    place.ontoggle = () => {
      if (parameters || !place.open) return;
      parameters = new Parameters(this.gateway, name, { tell: (words) => (problem.textContent = words), said: (words) => (said.textContent = words) });
      place.append(problem, parameters.element, said);
      parameters.fetch();
    };
    const [after] = [...this.#nodes.keys()].filter((each) => each > name).sort();
    this.#nodes.set(name, place);
    this.#tree.insertBefore(place, this.#nodes.get(after) ?? null);
  }
}
