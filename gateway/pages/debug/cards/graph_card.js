// SPDX-License-Identifier: Apache-2.0
import { element } from "../../shared/dom.js";
import { Card } from "./card.js";

const SVG = "http://www.w3.org/2000/svg";
const ROW = 26; // pixels
const COLUMNS = [8, 300, 620]; // publishing nodes, topics, subscribing nodes
const WIDE = 230;
const EVERYWHERE = /^\/(rosout|parameter_events|diagnostics)$|\/_/;

/** Nodes and topics: who publishes on the left, the topics in the middle, who subscribes on the right. */
export class GraphCard extends Card {
  #picture = element("div", { className: "graph", tabIndex: 0 });
  #all = element("input", { type: "checkbox" });
  #ignore = () => {};

  constructor(gateway, shown, actions) {
    super(gateway, shown, actions, { label: "graph", title: "Nodes and topics" });
    this.controls.append(element("label", { title: "also the log, parameter events, diagnostics and what is hidden" }, this.#all, " all"));
    this.#all.onchange = () => this.#write();
    this.body.append(this.#picture);
    this.element.classList.add("wide");
    this.#ignore = gateway.on("graph", () => this.#write());
    this.#write();
  }

  close() {
    this.#ignore();
    super.close();
  }

  #write() {
    const isShown = (name) => this.#all.checked || !EVERYWHERE.test(name);
    const topics = [...this.gateway.graph.topics.values()].filter(({ name }) => isShown(name)).sort(byName);
    const nodes = (kind) => [...new Set(topics.flatMap((each) => each[kind]))].filter(isShown).sort();
    const columns = [nodes("publishers"), topics.map(({ name }) => name), nodes("subscribers")];
    const places = columns.map((names) => new Map(names.map((name, row) => [name, row])));
    const picture = svg("svg", { width: COLUMNS[2] + WIDE + 8, height: Math.max(...columns.map((each) => each.length)) * ROW + 8, role: "group", "aria-label": "nodes and topics" });
    for (const { name, publishers, subscribers } of topics) {
      for (const node of new Set(publishers)) picture.append(line(places, [0, node], [1, name]));
      for (const node of new Set(subscribers)) picture.append(line(places, [1, name], [2, node]));
    }
    columns.forEach((names, column) => names.forEach((name, row) => picture.append(this.#box(picture, name, column, row))));
    const focused = this.#picture.contains(document.activeElement) ? document.activeElement.getAttribute("aria-label") : null;
    this.#picture.replaceChildren(picture);
    if (focused) /** @type {SVGElement|undefined} */ ([...picture.querySelectorAll("g")].find((each) => each.getAttribute("aria-label") === focused))?.focus();
    const count = new Set([...columns[0], ...columns[2]]).size;
    this.footer.textContent = `topics: ${topics.length} · nodes: ${count} · a click opens one`;
  }

  #box(picture, name, column, row) {
    const isTopic = column === 1;
    const box = svg("g", { class: isTopic ? "topic" : "node", tabindex: 0, role: "button", "aria-label": `${isTopic ? "topic" : "node"} ${name}` });
    const text = svg("text", { x: COLUMNS[column] + 8, y: row * ROW + 20 });
    text.textContent = name.length > 32 ? `${name.slice(0, 14)} … ${name.slice(-15)}` : name;
    box.append(svg("rect", { x: COLUMNS[column], y: row * ROW + 4, width: WIDE, height: ROW - 5, rx: isTopic ? 4 : 10 }), text);
    const open = () => this.actions.open(name, isTopic ? undefined : "node");
    box.addEventListener("click", open);
    box.addEventListener("keydown", ({ key }) => key === "Enter" && open());
    const mark = (isOn) => {
      for (const each of picture.querySelectorAll("path")) each.classList.toggle("on", isOn && each.dataset.ends.split(" ").includes(name));
    };
    for (const [event, isOn] of [["pointerenter", true], ["focus", true], ["pointerleave", false], ["blur", false]]) box.addEventListener(event, () => mark(isOn));
    return box;
  }
}

function line(places, [from, one], [to, other]) {
  const [x0, x1] = [COLUMNS[from] + WIDE, COLUMNS[to]];
  const [y0, y1] = [places[from].get(one), places[to].get(other)].map((row) => row * ROW + 4 + (ROW - 5) / 2);
  const path = svg("path", { d: places[from].has(one) && places[to].has(other) ? `M${x0} ${y0} C${x0 + 40} ${y0} ${x1 - 40} ${y1} ${x1} ${y1}` : "" });
  path.dataset.ends = `${one} ${other}`;
  return path;
}

function svg(name, attributes) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
}

const byName = (one, other) => one.name.localeCompare(other.name);
