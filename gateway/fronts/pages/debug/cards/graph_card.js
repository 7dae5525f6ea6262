// SPDX-License-Identifier: Apache-2.0
import { element } from "../../shared/dom.js";
import { count, say } from "../../shared/language.js";
import { Card } from "./card.js";

const SVG = "http://www.w3.org/2000/svg";
const ROW = 26; // pixels
const COLUMNS = [8, 300, 620]; // publishing nodes, topics, subscribing nodes
const WIDE = 230;
const EVERYWHERE = /^\/(rosout|parameter_events|diagnostics)$|\/_/;
const STEPS = { ArrowUp: [0, -1], ArrowDown: [0, 1], ArrowLeft: [-1, 0], ArrowRight: [1, 0], Home: [0, -Infinity], End: [0, Infinity] };

/** Nodes and topics: who publishes on the left, the topics in the middle, who subscribes on the right. */
export class GraphCard extends Card {
  #picture = element("div", { className: "graph" });
  #all = element("input", { type: "checkbox" });
  #boxes = []; // of each column, from above
  #links = []; // pairs of [column, name], that a line joins
  #current = null; // {column, name} of the box that Tab leads to
  #ignore = () => {};

  constructor(gateway, shown, actions) {
    super(gateway, shown, actions, { title: say("graph") });
    this.controls.append(element("label", { title: say("graph.all.about") }, this.#all, say("graph.all")));
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
    const picture = svg("svg", {
      width: COLUMNS[2] + WIDE + 8, height: Math.max(...columns.map((each) => each.length)) * ROW + 8,
      role: "group", "aria-label": say("graph.label"),
    });
    this.#links = topics.flatMap(({ name, publishers, subscribers }) => [
      ...[...new Set(publishers)].map((node) => [[0, node], [1, name]]),
      ...[...new Set(subscribers)].map((node) => [[1, name], [2, node]]),
    ]).filter((ends) => ends.every(([column, name]) => places[column].has(name)));
    for (const [from, to] of this.#links) picture.append(line(places, from, to));
    this.#boxes = columns.map((names, column) => names.map((name, row) => this.#box(picture, name, column, row)));
    picture.append(...this.#boxes.flat());
    const hadFocus = this.#picture.contains(document.activeElement);
    this.#picture.replaceChildren(picture);
    this.#lead(this.#find(this.#current) ?? this.#boxes.flat()[0], hadFocus);
    const all = new Set([...columns[0], ...columns[2]]).size;
    this.footer.textContent = [count("list.topic", topics.length), count("list.node", all), say("graph.hint")].join(" · ");
  }

  /** Let Tab lead to a box, and give it the focus if it is to have it. */
  #lead(box, hasFocus) {
    if (!box) return;
    for (const each of this.#boxes.flat()) each.setAttribute("tabindex", each === box ? 0 : -1);
    this.#current = { column: Number(box.dataset.column), name: box.dataset.name };
    if (hasFocus) box.focus();
  }

  #find(place) {
    return place && this.#boxes[place.column].find((each) => each.dataset.name === place.name);
  }

  /** Return the box that an arrow key leads to: in the same column the next. In another the first that a line leads to, or else the nearest. */
  #next(column, name, [aside, down]) {
    const row = this.#boxes[column].findIndex((each) => each.dataset.name === name);
    if (!aside) return this.#boxes[column][Math.max(0, Math.min(this.#boxes[column].length - 1, row + down))];
    const there = this.#boxes[column + aside] ?? [];
    const isLinked = (its) => this.#links.some(([from, to]) => (
      aside > 0 ? from[0] === column && from[1] === name && to[1] === its : to[0] === column && to[1] === name && from[1] === its
    ));
    return there.find((each) => isLinked(each.dataset.name)) ?? there[Math.min(row, there.length - 1)];
  }

  #box(picture, name, column, row) {
    const kind = column === 1 ? "topic" : "node";
    const box = svg("g", { class: kind, tabindex: -1, role: "button", "aria-label": say(`graph.${kind}`, { name }), "aria-description": this.#about(column, name) });
    Object.assign(box.dataset, { column, name });
    const text = svg("text", { x: COLUMNS[column] + 8, y: row * ROW + 20 });
    text.textContent = name.length > 32 ? `${name.slice(0, 14)} … ${name.slice(-15)}` : name;
    box.append(svg("rect", { x: COLUMNS[column], y: row * ROW + 4, width: WIDE, height: ROW - 5, rx: column === 1 ? 4 : 10 }), text);
    const open = () => this.actions.open(name, column === 1 ? undefined : "node");
    box.addEventListener("click", open);
    box.addEventListener("keydown", (event) => {
      if (event.key === "Enter" || event.key === " ") open();
      else if (event.key in STEPS) this.#lead(this.#next(column, name, STEPS[event.key]), true);
      else return;
      event.preventDefault(); // it would scroll, and so would the space bar
    });
    const mark = (isOn) => {
      for (const each of picture.querySelectorAll("path")) each.classList.toggle("on", isOn && each.dataset.ends.split(" ").includes(name));
    };
    box.addEventListener("focus", () => this.#lead(box, false));
    for (const [event, isOn] of [["pointerenter", true], ["focus", true], ["pointerleave", false], ["blur", false]]) box.addEventListener(event, () => mark(isOn));
    return box;
  }

  /** Return what the lines of a box say, in words. */
  #about(column, name) {
    const before = this.#links.filter(([, to]) => to[0] === column && to[1] === name).map(([[, its]]) => its);
    const after = this.#links.filter(([from]) => from[0] === column && from[1] === name).map(([, [, its]]) => its);
    if (column === 0) return say("graph.publishes", { names: after.join(", ") });
    if (column === 2) return say("graph.subscribes", { names: before.join(", ") });
    return say("graph.between", { publishers: before.join(", ") || say("graph.nobody"), subscribers: after.join(", ") || say("graph.nobody") });
  }
}

function line(places, [from, one], [to, other]) {
  const [x0, x1] = [COLUMNS[from] + WIDE, COLUMNS[to]];
  const [y0, y1] = [places[from].get(one), places[to].get(other)].map((row) => row * ROW + 4 + (ROW - 5) / 2);
  const path = svg("path", { d: `M${x0} ${y0} C${x0 + 40} ${y0} ${x1 - 40} ${y1} ${x1} ${y1}` });
  path.dataset.ends = `${one} ${other}`;
  return path;
}

function svg(name, attributes) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
}

const byName = (one, other) => one.name.localeCompare(other.name);
