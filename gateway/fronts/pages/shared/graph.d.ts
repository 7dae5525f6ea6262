// SPDX-License-Identifier: Apache-2.0
// by tools/page-types.sh
/** The ROS graph, as the gateway tells of it: names with what it says of each. */
export class Graph {
    /** @type {Map<string, {name: string, types: string[], publishers: string[], subscribers: string[]}>} */
    topics: Map<string, {
        name: string;
        types: string[];
        publishers: string[];
        subscribers: string[];
    }>;
    /** @type {Map<string, {name: string, types: string[], nodes: string[]}>} */
    services: Map<string, {
        name: string;
        types: string[];
        nodes: string[];
    }>;
    /** @type {Map<string, {name: string, types: string[], nodes: string[]}>} */
    actions: Map<string, {
        name: string;
        types: string[];
        nodes: string[];
    }>;
    /** @type {Set<string>} */
    nodes: Set<string>;
    /** Take a frame of the operation `graph`: all that there is, or what has changed. */
    update(frame: any): void;
    /** Return the type of a topic, or "". */
    typeOf(topic: any): string;
    /** Return the first topic of some types that a node publishes, or undefined. */
    published(...types: any[]): {
        name: string;
        types: string[];
        publishers: string[];
        subscribers: string[];
    };
}
