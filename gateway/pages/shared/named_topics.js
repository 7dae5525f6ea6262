// SPDX-License-Identifier: Apache-2.0
// Which topic of each kind a page shows: the one that its address names behind #, else the first that somebody publishes.

const KINDS = {
  camera: { what: "picture", types: ["sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"] },
  map: { what: "map", types: ["nav_msgs/msg/OccupancyGrid"] },
  scan: { what: "laser scan", types: ["sensor_msgs/msg/LaserScan"] },
  odometry: { what: "odometry", types: ["nav_msgs/msg/Odometry"] },
};
const COMMAND = "command";
const ALL = [...Object.keys(KINDS), COMMAND];

/** @typedef {"camera"|"map"|"scan"|"odometry"} Kind */

const address = () => new URLSearchParams(location.hash.slice(1));

/**
 * Return whether topics of a type are of a kind.
 * @param {string} type
 * @param {Kind} kind
 */
export const isOf = (type, kind) => KINDS[kind].types.includes(type);

/** Return the topic of a kind that the address names, or "". */
export const named = (kind) => address().get(kind) ?? "";

/** Return the topic that takes commands, if the address names one. */
export const namedCommand = () => named(COMMAND) || undefined;

/**
 * Return the topic of a kind, or "" while nobody publishes it.
 * @param {import("./graph.js").Graph} graph
 * @param {Kind} kind
 */
export function published(graph, kind) {
  const name = named(kind);
  if (!name) return graph.published(...KINDS[kind].types)?.name ?? "";
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
  if (!graph.topics.get(name)?.publishers.length) return `Nobody publishes ${name}, which the address of this page names.`;
  return `${name}, which the address of this page names, is no ${KINDS[kind].what} but of the type ${graph.typeOf(name)}.`;
}

/**
 * Say what in the address means nothing to a page of these kinds, once it is connected.
 * @param {import("./gateway.js").Gateway} gateway
 * @param {(words: string) => void} tell
 */
export function tellUnknown(gateway, tell) {
  const words = [...address().keys()].filter((key) => !ALL.includes(key)).map((key) => JSON.stringify(key.slice(0, 80)));
  const end = gateway.on("graph", () => {
    end();
    if (words.length) tell(`The address names what this page does not know: ${words.join(", ")}. It knows ${ALL.join(", ")}.`);
  });
}
