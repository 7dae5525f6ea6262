// SPDX-License-Identifier: Apache-2.0

/** The ROS graph, as the gateway tells of it: names with what it says of each. */
export class Graph {
  /** @type {Map<string, {name: string, types: string[], publishers: string[], subscribers: string[]}>} */
  topics = new Map();
  /** @type {Map<string, {name: string, types: string[], nodes: string[]}>} */
  services = new Map();
  /** @type {Map<string, {name: string, types: string[], nodes: string[]}>} */
  actions = new Map();
  /** @type {Set<string>} */
  nodes = new Set();

  /** Take a frame of the operation `graph`: all that there is, or what has changed. */
  update(frame) {
    const changes = frame.changes ?? frame;
    for (const kind of ["topics", "services", "actions"]) {
      if (!frame.changes) this[kind].clear();
      for (const each of changes[kind] ?? []) this[kind].set(each.name, each);
      for (const name of changes[`gone_${kind}`] ?? []) this[kind].delete(name);
    }
    if (!frame.changes) this.nodes.clear();
    for (const name of changes.nodes ?? []) this.nodes.add(name);
    for (const name of changes.gone_nodes ?? []) this.nodes.delete(name);
  }

  /** Return the type of a topic, or "". */
  typeOf(topic) {
    return this.topics.get(topic)?.types[0] ?? "";
  }

  /** Return the first topic of some types that a node publishes, or undefined. */
  published(...types) {
    return [...this.topics.values()].find((each) => each.publishers.length && types.includes(each.types[0]));
  }
}
