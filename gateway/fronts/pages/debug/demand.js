// SPDX-License-Identifier: Apache-2.0

/** All that one card asks a gateway to send again and again. While the card rests the gateway sends none of it. */
export class Demand {
  /** The gateway as the card and its view use it: what they subscribe to rests with the card. @type {import("../shared/gateway.js").Gateway} */
  gateway;
  isResting = false;
  #streams = new Set(); // {begin, end}

  /** @param {import("../shared/gateway.js").Gateway} gateway */
  constructor(gateway) {
    const own = {
      subscribe: (...asked) => this.#add(() => gateway.subscribe(.../** @type {Parameters<typeof gateway.subscribe>} */ (asked))),
      followTransform: (...asked) => this.#add(() => gateway.followTransform(.../** @type {Parameters<typeof gateway.followTransform>} */ (asked))),
    };
    this.gateway = new Proxy(gateway, {
      get(_, name) {
        if (Object.hasOwn(own, name)) return own[name];
        const value = Reflect.get(gateway, name);
        return typeof value === "function" ? value.bind(gateway) : value; // its private members are not those of a proxy
      },
    });
  }

  /** End all of it at the gateway. */
  rest() {
    this.isResting = true;
    for (const each of this.#streams) each.end();
  }

  /** Ask for all of it again. Latched messages come once more. */
  wake() {
    this.isResting = false;
    for (const each of this.#streams) each.end = each.begin();
  }

  #add(begin) {
    const stream = { begin, end: this.isResting ? () => {} : begin() };
    this.#streams.add(stream);
    return () => this.#streams.delete(stream) && !this.isResting && stream.end();
  }
}
