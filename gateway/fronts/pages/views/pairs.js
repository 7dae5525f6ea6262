// SPDX-License-Identifier: Apache-2.0
import { element } from "../shared/dom.js";

/** Names with values below each other. A row stays while its name does, and what is selected in it stays selected. */
export class Pairs {
  element = element("dl", { className: "pairs" });
  #rows = new Map(); // name -> the place of its value

  /** @param {[string, string][]} pairs of a name and what is said of it */
  show(pairs) {
    const names = new Set(pairs.map(([name]) => name));
    for (const [name, place] of this.#rows) {
      if (names.has(name)) continue;
      place.parentElement.remove();
      this.#rows.delete(name);
    }
    for (const [name, text] of pairs) {
      const place = this.#rows.get(name) ?? this.#add(name);
      if (place.textContent !== text) place.textContent = text;
    }
  }

  #add(name) {
    const place = element("dd");
    this.element.append(element("div", {}, element("dt", {}, element("bdi", {}, name)), place));
    this.#rows.set(name, place);
    return place;
  }
}
