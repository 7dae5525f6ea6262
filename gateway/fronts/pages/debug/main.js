// SPDX-License-Identifier: Apache-2.0
// The debug page: what the robot says, and STOP.

import * as bar from "../shared/bar.js";
import { element, find } from "../shared/dom.js";
import { Gateway } from "../shared/gateway.js";
import { isTaken } from "../shared/keys.js";
import { say } from "../shared/language.js";
import { menu } from "../shared/menu.js";
import * as page from "./address.js";
import { TopicCard } from "./cards/topic_card.js";
import { Desk } from "./desk.js";
import { EmptyState } from "./empty_state.js";
import { Figures } from "./figures.js";
import { FirstVisit } from "./first_visit.js";
import * as layouts from "./layouts.js";
import { Measuring } from "./measuring.js";
import { NameList } from "./name_list.js";
import { RobotPicker } from "./robots.js";
import { lead } from "./roving.js";
import * as tabs from "./tabs.js";
import { TopicList } from "./topic_list.js";
import { isView, viewsFor } from "../views/views.js";

const NARROW = 720; // pixels, as style.css has it: the cards stand above the list
const MOST_FIELDS = 4; // in one plot

/** @type {[string, string][]} */
const KEYS = [
  ["/", say("keys.search")],
  ["↑ ↓ Home End", say("keys.list")], ["Enter", say("keys.open")],
  ["m", say("keys.maximise")], ["Escape", say("keys.restore")], ["[ ]", say("keys.move")], ["← ↑ ↓ →", say("keys.resize")],
];

const gateway = new Gateway({ say });
const figures = new Figures(gateway);
const counts = {}; // by tab, how many of how many it lists
let tab = "tab-topics"; // that is shown
const measuring = new Measuring(gateway);
const robots = new RobotPicker(find("robot"), gateway, {
  robot: page.word("robot"), all: say("robot.all"), changed: () => {
    find("search").dispatchEvent(new Event("input")); // to which the lists listen
    keep();
  },
});
const topics = new TopicList(find("topics"), find("search"), gateway, measuring, {
  open: (name) => open(name), plot: (name) => open(name, "plot"), drive: (name) => open(name, "drive"), publish: (name) => open(name, "publish"), allows: (name) => robots.allows(name), counted: (words) => counted("tab-topics", words),
});
const none = element("p", { className: "empty", tabIndex: -1 }, say("empty.choose"));
const empty = new EmptyState(gateway);
let wanted = page.read();
const firstVisit = new FirstVisit(gateway, add);
if (wanted) firstVisit.end();
const desk = new Desk(find("cards"), find("desk-tabs"), gateway, { changed, open, grown, left });

function add(shown) {
  const card = desk.add(shown);
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
  const plots = desk.cards.filter((each) => each.view === "plot" && each.topic === topic);
  const found = plots.find((each) => each.fields.includes(field));
  if (found) return found;
  const plot = plots.find((each) => each.fields.length < MOST_FIELDS);
  if (plot instanceof TopicCard) plot.join(field);
  return plot;
}

/** Return the card that shows a name in a view, by default a topic in any. A plot is another one for each choice of fields. */
function shownBy(topic, view) {
  return desk.cards.find((each) => each.topic === topic && (view ? each.view === view && !each.fields.length : isView(each.view)));
}

/** Bring a card into view, and the focus to it. */
function look(card) {
  const { element: its } = card;
  desk.find(card);
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

/** Give the focus of a card that was closed to the next one. */
function left(next) {
  (next?.element ?? find("search")).focus();
}

/** Take what a person has changed. */
function changed() {
  firstVisit.end();
  keep();
}

/** Keep the cards in the address. Without a card, say how to open one. */
function keep() {
  const isAwaited = !desk.cards.length && !firstVisit.isOver; // a reload is also a first visit
  const tabs = desk.tabs.map(({ name, cards }) => ({ name, cards: cards.map((each) => each.shown) }));
  page.write(isAwaited ? null : tabs, desk.tabs.indexOf(desk.tab), { measure: measuring.isOn ? "all" : "", robot: robots.robot });
  for (const [list, isOf] of lists) list.mark(new Set(desk.cards.filter((each) => isOf(each.view)).map((each) => each.topic)));
  desk.write();
  empty.element.remove();
  none.remove();
  if (!desk.tab.cards.length) find("cards").append(isAwaited ? empty.element : none);
}

/** Open what the address names, and say what nobody knows. */
function restore({ tabs, at, unknown }) {
  for (const { name, cards } of tabs) {
    if (name) desk.restore(name);
    for (const shown of cards) desk.add(shown);
  }
  desk.show(desk.tabs[at] ?? desk.tab);
  keep();
  if (unknown.length) bar.tell(say("address.cards", { names: unknown.map((each) => JSON.stringify(each.slice(0, 80))).join(", ") }));
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
  for (const card of desk.tab.cards) card.tick();
}

function draw(ms) {
  requestAnimationFrame(draw); // first: whatever fails here, the next frame comes
  for (const card of desk.tab.cards) if (card.isSeen) card.draw(ms);
}

gateway.on("graph", () => {
  if (wanted) restore(wanted);
  wanted = null;
  empty.write();
  firstVisit.fill();
  if (!desk.cards.length && !firstVisit.isOver) keep();
});

const measure = find("measure");
measure.checked = measuring.isOn = page.word("measure") !== "";
measure.onchange = () => {
  measuring.isOn = measure.checked;
  keep();
};

const everywhere = (types) => types.some((each) => each.startsWith("rcl_interfaces/")); // each node has these
const services = new NameList(find("services"), find("search"), gateway, {
  kind: "service",
  entries: ({ services }) => [...services.values()].map(({ name, types }) => ({ name, about: types.join(", "), isPlain: !everywhere(types) })),
  open: (name) => open(name, "call"),
  allows: robots.allows,
  counted: (words) => counted("tab-services", words),
});
const actions = new NameList(find("actions"), find("search"), gateway, {
  kind: "action",
  entries: ({ actions }) => [...actions.values()].map(({ name, types }) => ({ name, about: types.join(", "), isPlain: true })),
  open: (name) => open(name, "goal"),
  allows: robots.allows,
  counted: (words) => counted("tab-actions", words),
});
const nodes = new NameList(find("nodes"), find("search"), gateway, {
  kind: "node",
  entries: ({ nodes }) => [...nodes].map((name) => ({ name, about: "", isPlain: !name.includes("/_") })),
  open: (name) => open(name, "node"),
  allows: robots.allows,
  counted: (words) => counted("tab-nodes", words),
});
/** The lists that mark names with a card, and the views of each kind. @type {[TopicList|NameList, (view: string) => boolean][]} */
const lists = [[topics, isView], [services, (view) => view === "call"], [actions, (view) => view === "goal"], [nodes, (view) => view === "node"]];
find("graph").onclick = () => open("/", "graph");
find("parameters").onclick = () => open("/", "parameters");
find("skip").onclick = (event) => {
  event.preventDefault(); // the part after # is the shown cards
  (desk.tab.cards[0]?.element ?? find("cards")).focus();
};
tabs.connect(find("tabs"), ({ id }) => {
  tab = id;
  counted(id, counts[id]);
});
lead(find("search"), () => find(tab.replace("tab", "panel")));
find("scene").onclick = () => open("/", "scene");
bar.connect(gateway, "debug", {
  figures: [figures.element, menu(say("layout.menu"), () => [...layouts.entries(), { label: say("tab.menu") }, ...desk.entries], say("layout.menu"))],
  keys: KEYS,
  entries: [
    { label: say("list.fold"), act: () => topics.fold(true) },
    { label: say("list.unfold"), act: () => topics.fold(false) },
    { label: say("menu.limits"), act: () => open("/", "connection") },
  ],
});
addEventListener("keydown", (event) => {
  if (event.key !== "/" || isTaken(event) || event.ctrlKey || event.altKey || event.metaKey) return;
  event.preventDefault();
  desk.maximise(null); // it hides the list
  find("search").select();
});
gateway.connect();
tick();
setInterval(tick, 1000);
requestAnimationFrame(draw);
