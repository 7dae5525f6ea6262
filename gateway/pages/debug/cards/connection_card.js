// SPDX-License-Identifier: Apache-2.0
import { element } from "../../shared/dom.js";
import { Card } from "./card.js";

/** The connection of this page: what it was told at its beginning, and what came of each topic. */
export class ConnectionCard extends Card {
  #about = element("dl", { className: "pairs" });
  #topics = element("dl", { className: "pairs" });

  constructor(gateway, shown, actions) {
    super(gateway, shown, actions, { label: "connection", title: "Connection" });
    this.body.append(this.#about, element("h4", {}, "Topics"), this.#topics);
    this.tick();
  }

  tick() {
    const { limits = {}, ...others } = this.gateway.hello ?? {};
    const about = { ...others, ...limits };
    for (const unneeded of ["op", "id"]) delete about[unneeded];
    write(this.#about, Object.entries(about).map(([name, value]) => [name, String(value)]));
    write(this.#topics, [...this.gateway.arrivals].map(([name, { words }]) => [name, words]));
    this.footer.textContent = this.gateway.hello ? "as the gateway has told" : "not connected";
  }
}

function write(list, pairs) {
  list.replaceChildren(...pairs.map(([name, value]) => element("div", {}, element("dt", {}, name), element("dd", {}, value))));
}
