// SPDX-License-Identifier: Apache-2.0
import { element } from "../shared/dom.js";
import { count, say } from "../shared/language.js";

const REACHES = ["SUBNET", "LOCALHOST", "OFF", "ROUTER"];

/** The page without a robot: what to start, and where the gateway searches for one. `write` is called at each change of the graph. */
export class EmptyState {
  element = element("section", { className: "empty", aria: { label: say("empty.title") } });
  #gateway;

  /** @param {import("../shared/gateway.js").Gateway} gateway */
  constructor(gateway) {
    this.#gateway = gateway;
    this.write();
  }

  write() {
    const { domain_id: domain, rmw, discovery: reach } = this.#gateway.hello ?? {};
    const discovery = REACHES.includes(reach) ? say(`reach.${reach}`) : reach;
    const { topics, services, nodes } = this.#gateway.graph;
    const found = [count("list.topic", topics.size), count("list.service", services.size), count("list.node", nodes.size)].join(", ");
    const known = { domain, rmw, discovery, found };
    const rows = Object.entries(known).filter(([, value]) => value !== undefined && value !== "");
    this.element.replaceChildren(
      element("h3", {}, say("empty.title")),
      element("p", {}, say("empty.start"), element("code", {}, "ros2-gateway demo"), "."),
      element("dl", { className: "pairs" }, ...rows.map(([key, value]) => element("div", {}, element("dt", {}, say(`empty.${key}`)), element("dd", {}, String(value))))),
      element("p", {}, say("empty.check")),
      element("p", {}, say("empty.doctor"), element("code", {}, "ros2-gateway doctor"), "."),
    );
  }
}
