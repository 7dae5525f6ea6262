// SPDX-License-Identifier: Apache-2.0
// Which topic of each kind a page shows: the one that its address names after #, else the first that a node publishes.

import { say } from "./language.js";

const KINDS = {
  camera: { types: ["sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"] },
  map: { types: ["nav_msgs/msg/OccupancyGrid"] },
  scan: { types: ["sensor_msgs/msg/LaserScan"] },
  odometry: { types: ["nav_msgs/msg/Odometry"] },
  battery: { types: ["sensor_msgs/msg/BatteryState"] },
  cloud: { types: ["sensor_msgs/msg/PointCloud2"] },
  description: { types: ["std_msgs/msg/String"], ending: "robot_description" },
  footprint: { types: ["geometry_msgs/msg/PolygonStamped"], ending: "footprint" }, // other polygons are not the robot's
};
const COMMAND = "command";
const ALL = [...Object.keys(KINDS), COMMAND];

/** @typedef {"camera"|"map"|"scan"|"odometry"|"battery"|"footprint"|"cloud"|"description"} Kind */

const address = () => new URLSearchParams(location.hash.slice(1));

/**
 * Return whether topics of a type are of a kind.
 * @param {string} type
 * @param {Kind} kind
 */
export const isOf = (type, kind) => KINDS[kind].types.includes(type);

/** Return the topic of a kind that the address names, or "". */
export function named(kind) {
  const name = address().get(kind) ?? "";
  return !name || name.startsWith("/") ? name : `/${name}`;
}

/** Name a topic of a kind in the address, without loading the page again. */
export function choose(kind, name) {
  const names = address();
  names.set(kind, name);
  history.replaceState(history.state, "", `#${names.toString().replaceAll("%2F", "/")}`);
}

/** Return the topic that takes commands, if the address names one. */
export const namedCommand = () => named(COMMAND) || undefined;

/**
 * Return the topic of a kind, or "" while nobody publishes it.
 * @param {import("./graph.js").Graph} graph
 * @param {Kind} kind
 */
export function published(graph, kind) {
  const name = named(kind);
  const { types, ending = "" } = KINDS[kind];
  if (!name) return [...graph.topics.values()].find((each) => each.publishers.length && types.includes(each.types[0]) && each.name.endsWith(ending))?.name ?? "";
  return graph.topics.get(name)?.publishers.length && isOf(graph.typeOf(name), kind) ? name : "";
}

/**
 * Return why there is no topic of a kind that the address names, in words, or "" if there is one or none is named.
 * @param {import("./graph.js").Graph} graph
 * @param {Kind} kind
 */
export function missing(graph, kind) {
  const name = named(kind);
  if (!name || !graph.topics.size || published(graph, kind)) return ""; // before it is known what there is, nothing is missing
  if (!graph.topics.get(name)?.publishers.length) return say("address.unpublished", { name });
  return say("address.type", { name, kind: say(`kind.${kind}`), type: graph.typeOf(name) });
}

/**
 * Say what is wrong with the address, once it is known what there is.
 * @param {import("./gateway.js").Gateway} gateway
 * @param {(words: string, isOver?: () => boolean) => void} tell
 * @param {...Kind} kinds to report here, if no node publishes the named topic
 */
export function tellWrong(gateway, tell, ...kinds) {
  const end = gateway.on("graph", () => {
    if (!gateway.graph.topics.size) return;
    end();
    const unpublished = () => kinds.map((kind) => missing(gateway.graph, kind)).filter(Boolean).join(" ");
    if (mistake()) tell(mistake());
    else if (unpublished()) tell(unpublished(), () => !unpublished());
  });
}

/** The mistake in the address, in words, or "". */
function mistake() {
  const keys = [...address().keys()];
  const unknown = keys.filter((key) => !ALL.includes(key)).map((key) => JSON.stringify(key.slice(0, 80)));
  if (unknown.length) return say("address.unknown", { names: unknown.join(", "), all: ALL.join(", ") });
  const again = keys.find((key, at) => keys.indexOf(key) !== at);
  if (again) return say("address.again", { name: again, count: address().getAll(again).length });
  const behind = [...new URLSearchParams(location.search).keys()].find((key) => ALL.includes(key));
  return behind ? say("address.behind", { name: behind }) : "";
}
