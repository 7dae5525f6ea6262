// SPDX-License-Identifier: Apache-2.0
import { BASE } from "../shared/base.js";
import { bytes, element } from "../shared/dom.js";
import { say } from "../shared/language.js";

const HEALTH_MS = 4000;
const ABOUT = {
  dropped: say("figures.dropped.about"),
  clients: say("figures.clients.about"),
};

/** The connection in numbers, for the bar. `tick` is called once a second. */
export class Figures {
  element = element("dl", { id: "figures", className: "figures", aria: { label: say("connection") } });
  #gateway;
  #before;
  #health = null; // of the gateway, for everybody
  #askedMs = -HEALTH_MS;

  /** @param {import("../shared/gateway.js").Gateway} gateway */
  constructor(gateway) {
    this.#gateway = gateway;
    this.#before = this.#now();
  }

  tick() {
    const [before, now] = [this.#before, this.#now()];
    this.#before = now;
    const seconds = Math.max(0.001, (now.ms - before.ms) / 1000);
    this.#write({
      trip: now.roundTripMs === null ? "–" : `${now.roundTripMs.toFixed(1)} ms`,
      messages: `${Math.round((now.frames - before.frames) / seconds)}/s`,
      data: `${bytes((now.bytes - before.bytes) / seconds)}/s`,
      dropped: `${now.dropped}`,
      clients: `${this.#health?.clients ?? "–"}`,
      role: this.#gateway.hello?.role ?? "–",
    });
    if (now.ms - this.#askedMs >= HEALTH_MS) this.#ask(now.ms);
  }

  #now() {
    return { ...this.#gateway.counts, ms: performance.now() };
  }

  async #ask(ms) {
    this.#askedMs = ms;
    if (this.#gateway.counts.roundTripMs === null) { // without a connection it would fail, and say so in the console
      this.#health = null;
      return;
    }
    try {
      this.#health = await (await fetch(`${BASE}/healthz`)).json();
    } catch {
      this.#health = null; // the connection's own state says more
    }
  }

  #write(figures) {
    this.element.replaceChildren(
      ...Object.entries(figures).map(([name, value]) => element("div", { title: ABOUT[name] ?? "" }, element("dt", {}, say(`figures.${name}`)), element("dd", {}, value))),
    );
    const { scrollWidth, clientWidth } = this.element;
    this.element.tabIndex = scrollWidth > clientWidth ? 0 : -1; // on a phone a key also scrolls it
  }
}
