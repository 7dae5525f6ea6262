// SPDX-License-Identifier: Apache-2.0
// The debug page: what the robot says, and STOP.

import * as bar from "../shared/bar.js";
import { element, find } from "../shared/dom.js";
import { Gateway } from "../shared/gateway.js";
import * as page from "./address.js";
import { makeCard } from "./cards/cards.js";
import { TopicCard } from "./cards/topic_card.js";
import { Figures } from "./figures.js";
import { FirstVisit } from "./first_visit.js";
import { Measuring } from "./measuring.js";
import { NameList } from "./name_list.js";
import * as tabs from "./tabs.js";
import { TopicList } from "./topic_list.js";
import { isView, viewsFor } from "../views/views.js";

const NARROW = 720; // pixels, as style.css has it: the cards stand above the list
const MOST_FIELDS = 4; // in one plot
const NO_ROBOT = "There are no topics yet. Start a robot, or the simulated one with ";

const gateway = new Gateway();
const figures = new Figures(gateway);
const counts = {}; // by tab, how many of how many it lists
let tab = "tab-topics"; // that is shown
const measuring = new Measuring(gateway);
const topics = new TopicList(find("topics"), find("search"), gateway, measuring, {
  open: (name) => open(name), plot: (name) => open(name, "plot"), drive: (name) => open(name, "drive"), publish: (name) => open(name, "publish"), counted: (words) => counted("tab-topics", words),
});
const none = element("p", { className: "empty", tabIndex: -1 }, "Choose a topic in the list. ✎ publishes on it.");
const empty = element("p", { className: "empty" }, NO_ROBOT, element("code", {}, "ros2-gateway demo"), ".");
let wanted = page.read();
const firstVisit = new FirstVisit(gateway, add);
if (wanted) firstVisit.end();
const cards = [];

function add(shown) {
  const card = makeCard(gateway, shown, { changed, close, open, grown });
  cards.push(card);
  find("cards").append(card.element);
  keep();
  return card;
}

/** Open a name of the ROS graph, by default a topic in the view that fits it best, or show its card. A plot takes a further field. */
function open(topic, asked, fields = []) {
  firstVisit.end();
  const shown = fields.length ? plotOf(topic, fields[0]) : shownBy(topic, asked);
  look(shown ?? add({ topic, view: asked ?? viewsFor(gateway.graph.typeOf(topic))[0], fields, rate: 0 }));
}

/** Return a plot that has a field of a topic. One that has room takes it. */
function plotOf(topic, field) {
  const plots = cards.filter((each) => each.view === "plot" && each.topic === topic);
  const found = plots.find((each) => each.fields.includes(field));
  if (found) return found;
  const plot = plots.find((each) => each.fields.length < MOST_FIELDS);
  if (plot instanceof TopicCard) plot.join(field);
  return plot;
}

/** Return the card that shows a name in a view, by default a topic in any. A plot is another one for each choice of fields. */
function shownBy(topic, view) {
  return cards.find((each) => each.topic === topic && (view ? each.view === view && !each.fields.length : isView(each.view)));
}

/** Bring a card into view, and the focus to it. */
function look({ element: its }) {
  its.focus({ preventScroll: true });
  reveal(its);
}

/** Bring a card into view again that has got its form, unless the user has gone elsewhere. */
function grown({ element: its }) {
  if (its.contains(document.activeElement)) reveal(its);
}

function reveal(its) {
  its.scrollIntoView({ block: innerWidth < NARROW ? "start" : "nearest" });
}

function close(card) {
  const index = cards.indexOf(card);
  const hadFocus = card.element.contains(document.activeElement);
  card.close();
  cards.splice(index, 1);
  changed();
  if (hadFocus) (cards[Math.min(index, cards.length - 1)]?.element ?? find("search")).focus();
}

/** Take what a person has changed. */
function changed() {
  firstVisit.end();
  keep();
}

/** Keep the shown cards in the address. Without a card, say how to open one. */
function keep() {
  const isAwaited = !cards.length && !firstVisit.isOver; // a reload is also a first visit
  page.write(isAwaited ? null : cards.map((each) => each.shown), measuring.isOn);
  for (const [list, isOf] of lists) list.mark(new Set(cards.filter((each) => isOf(each.view)).map((each) => each.topic)));
  empty.remove();
  none.remove();
  if (!cards.length) find("cards").append(isAwaited ? empty : none);
}

/** Open what the address names, and say what nobody knows. */
function restore({ cards: known, unknown }) {
  for (const shown of known) add(shown);
  if (unknown.length) bar.tell(`The address names unknown cards: ${unknown.map((each) => JSON.stringify(each.slice(0, 80))).join(", ")}.`);
  if (!known.length) changed();
}

/** Keep how many of how many a tab lists, and say it of the one that is shown. */
function counted(of, words) {
  counts[of] = words;
  const shown = counts[tab] ?? "";
  if (find("count").textContent !== shown) find("count").textContent = shown; // it is read out
}

function tick() {
  figures.tick();
  measuring.tick();
  topics.tick();
  for (const card of cards) card.tick();
}

function draw(ms) {
  requestAnimationFrame(draw); // first: whatever fails here, the next frame comes
  for (const card of cards) if (card.isSeen) card.draw(ms);
}

gateway.on("graph", () => {
  if (wanted) restore(wanted);
  wanted = null;
  firstVisit.fill();
  if (!cards.length && !firstVisit.isOver) keep();
});

const measure = find("measure");
measure.checked = measuring.isOn = page.isMeasuring();
measure.onchange = () => {
  measuring.isOn = measure.checked;
  keep();
};

const everywhere = (types) => types.some((each) => each.startsWith("rcl_interfaces/")); // each node has these
const services = new NameList(find("services"), find("search"), gateway, {
  kind: "service",
  entries: ({ services }) => [...services.values()].map(({ name, types }) => ({ name, about: types.join(", "), isPlain: !everywhere(types) })),
  open: (name) => open(name, "call"),
  counted: (words) => counted("tab-services", words),
});
const actions = new NameList(find("actions"), find("search"), gateway, {
  kind: "action",
  entries: ({ actions }) => [...actions.values()].map(({ name, types }) => ({ name, about: types.join(", "), isPlain: true })),
  open: (name) => open(name, "goal"),
  counted: (words) => counted("tab-actions", words),
});
const nodes = new NameList(find("nodes"), find("search"), gateway, {
  kind: "node",
  entries: ({ nodes }) => [...nodes].map((name) => ({ name, about: "", isPlain: !name.includes("/_") })),
  open: (name) => open(name, "node"),
  counted: (words) => counted("tab-nodes", words),
});
/** The lists that mark names with a card, and the views of each kind. @type {[TopicList|NameList, (view: string) => boolean][]} */
const lists = [[topics, isView], [services, (view) => view === "call"], [actions, (view) => view === "goal"], [nodes, (view) => view === "node"]];
const limits = element("button", { type: "button", title: "the limits and the messages of this connection" }, "Limits");
limits.onclick = () => open("/", "connection");
find("graph").onclick = () => open("/", "graph");
find("skip").onclick = (event) => {
  event.preventDefault(); // the part after # is the shown cards
  (cards[0]?.element ?? find("cards")).focus();
};
tabs.connect(find("tabs"), ({ id }) => {
  tab = id;
  counted(id, counts[id]);
});
bar.connect(gateway, "Debug", figures.element, limits);
gateway.connect();
tick();
setInterval(tick, 1000);
requestAnimationFrame(draw);
