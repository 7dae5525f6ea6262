// SPDX-License-Identifier: Apache-2.0
import { element } from "../../shared/dom.js";
import { say } from "../../shared/language.js";
import { wordsOf } from "../arrival_words.js";
import { worded } from "../limits.js";
import { Card } from "./card.js";

/** The connection of this page: what it was told at its beginning, and what came of each topic. */
export class ConnectionCard extends Card {
  #about = element("dl", { className: "pairs" });
  #topics = element("dl", { className: "pairs" });

  constructor(gateway, shown, actions) {
    super(gateway, shown, actions, { title: say("connection") });
    this.body.append(this.#about, element("h4", {}, say("list.topics")), this.#topics);
    this.tick();
  }

  tick() {
    const { limits = {}, ...others } = this.gateway.hello ?? {};
    const about = { ...others, ...limits };
    for (const unneeded of ["op", "id"]) delete about[unneeded];
    write(this.#about, Object.entries(about).map(([key, its]) => {
      const { words, value } = worded(key, its);
      return [[words, ...(words === key ? [] : [" ", element("small", {}, key)])], value];
    }));
    const shown = [...this.gateway.arrivals].filter(([name]) => name.startsWith("/")); // the others are measured only
    write(this.#topics, shown.map(([name, arrivals]) => [[name], wordsOf(arrivals)]));
    this.footer.textContent = this.gateway.hello ? say("connection.reported") : say("unconnected");
  }
}

/** @param {[(string|Node)[], string][]} pairs the left and the right side */
function write(list, pairs) {
  list.replaceChildren(...pairs.map(([about, value]) => element("div", {}, element("dt", {}, ...about), element("dd", {}, value))));
}
