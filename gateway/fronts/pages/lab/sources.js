// SPDX-License-Identifier: Apache-2.0
// The robot's data that the lab shows, once a node publishes it.

import { say } from "../shared/language.js";
import { json } from "../shared/json.js";
import { isOf, missing, published } from "../shared/named_topics.js";
import { lasting } from "../shared/passing.js";
import { MAP_OPTIONS } from "../views/painter.js";
import { Placement } from "./placement.js";

const LOGS = "rcl_interfaces/msg/Log";
/** @type {import("../shared/named_topics.js").Kind[]} */
const KINDS = ["odometry", "map", "scan", "camera", "cloud", "description"];
const JOINTS = "sensor_msgs/msg/JointState";
const FAVOURITES = ["sensor_msgs/msg/BatteryState", "std_msgs/msg/String"]; // for the screen that shows any topic
const FAST_MS = 33;
const SLOW_MS = 250;
const MAP_HZ = 5; // of its place: odometry drifts slowly, and jumps when the robot finds itself
const LASER_HZ = 1; // of its place: it is screwed on
const ROOT_HZ = 1; // of the root of the description

/** Subscriptions of the lab. */
export class Sources {
  #gateway;
  #tell;
  #known = new Map(); // kind -> topic
  #parts;
  #map; // the place of its frame in the odometry's
  #laser; // its place on the robot
  /** The frame of the odometry, or "". */
  frame = "";
  #root; // the place of the description's root on the robot

  /**
   * @param {import("../shared/gateway.js").Gateway} gateway
   * @param {(words: string) => void} tell
   * @param {{twin: import("./twin.js").Twin, map: import("./floor_map.js").FloorMap, cloud: import("./cloud.js").Cloud}} parts
   */
  constructor(gateway, tell, parts) {
    this.#gateway = gateway;
    this.#tell = tell;
    this.#parts = parts;
    this.#map = new Placement(gateway, say("hidden.map"), MAP_HZ, (transform) => parts.map.place(transform));
    this.#laser = new Placement(gateway, say("hidden.scan"), LASER_HZ, (transform) => parts.twin.mount(transform));
    this.#root = new Placement(gateway, say("hidden.description"), ROOT_HZ, (transform) => parts.twin.body.mount(transform));
  }

  /** In words, what is not shown because it is not published or its place is unknown, or "". */
  get missing() {
    const unpublished = KINDS.map((kind) => missing(this.#gateway.graph, kind));
    const { twin, cloud } = this.#parts;
    return [...unpublished, this.#map.words, this.#laser.words, cloud.words, this.#root.words, twin.body.problem].filter(Boolean).join("\n");
  }

  /** Subscribe to what has come: call it after each change of the graph. */
  watch({ pilot, motion, television, log, logged }) {
    const { graph } = this.#gateway;
    const { twin, map, cloud } = this.#parts;
    this.#show("odometry", published(graph, "odometry"), { compression: "cbor", throttle_rate: FAST_MS }, (message) => {
      twin.odometry(message);
      pilot.odometry(twin.pose);
      motion.odometry(message);
      this.#map.within(message.header.frame_id);
      this.#laser.within(message.child_frame_id);
      cloud.within(message.header.frame_id);
      this.frame = message.header.frame_id;
      if (twin.body.root) this.#root.within(message.child_frame_id);
    });
    this.#describe();
    this.#open("cloud", (topic) => cloud.open(topic));
    if (!this.#known.has("map") && published(graph, "map")) map.follow(this.#gateway, published(graph, "map"));
    this.#show("map", published(graph, "map"), MAP_OPTIONS, (message) => {
      map.take(message);
      this.#map.of(message.header.frame_id);
    });
    this.#show("scan", published(graph, "scan"), { compression: "cbor", throttle_rate: 100 }, (message) => {
      twin.scan(message);
      this.#laser.of(message.header.frame_id);
    });
    this.#show("camera", published(graph, "camera"), television.options, (message) => television.show(message));
    this.#show("log", graph.published(LOGS)?.name ?? "", {}, (line) => {
      log.add(`${line.name}: ${line.msg}`);
      logged(line);
    });
  }

  /** Return what has come of a kind, or undefined. */
  arrivals(kind) {
    return this.#gateway.arrivals.get(this.#known.get(kind));
  }

  /** Return the topics that a screen can show as text, which excludes images. */
  get readable() {
    return [...this.#gateway.graph.topics.values()]
      .filter(({ publishers, types }) => publishers.length && !isOf(types[0], "camera"))
      .map(({ name }) => name).sort();
  }

  /** Return the topic that a screen shows at first, or "". */
  get favourite() {
    for (const type of FAVOURITES) {
      const topic = this.#gateway.graph.published(type);
      if (topic) return topic.name;
    }
    return this.readable[0] ?? "";
  }

  /** Show a topic on a screen as text. Return what ends that. */
  read(topic, screen) {
    screen.show(topic, say("arrivals.none"));
    return this.#gateway.subscribe(
      topic, { throttle_rate: SLOW_MS },
      (message) => screen.show(topic, readable(message)),
      lasting(this.#tell),
    );
  }

  /** Dress the robot by its description, and move its joints as the joint states next to that say. */
  #describe() {
    const { body } = this.#parts.twin;
    const lasts = lasting(this.#tell);
    this.#open("description", (topic) => {
      this.#gateway.subscribe(topic, {}, ({ data }) => {
        try {
          body.describe(this.#gateway, data);
          this.#root.of(body.root);
        } catch (error) {
          this.#tell(say("lab.description", { why: error.message }));
        }
      }, lasts);
    });
    const described = this.#known.get("description") ?? "";
    const joints = `${described.slice(0, described.lastIndexOf("/"))}/joint_states`;
    if (!described || this.#known.has("joints") || this.#gateway.graph.typeOf(joints) !== JOINTS) return;
    this.#known.set("joints", joints);
    this.#gateway.subscribe(joints, { throttle_rate: FAST_MS, fields: ["name", "position"] }, (message) => body.move(message), () => {});
  }

  /** Open a kind once, when it is published. */
  #open(kind, open) {
    const topic = published(this.#gateway.graph, kind);
    if (!topic || this.#known.has(kind)) return;
    this.#known.set(kind, topic);
    open(topic);
  }

  #show(kind, topic, options, onMessage) {
    if (!topic || this.#known.has(kind)) return;
    this.#known.set(kind, topic);
    this.#gateway.subscribe(topic, options, onMessage, lasting(this.#tell));
  }
}

/** Return a message as text for people: a string as it is, the rest without what only programs need. */
function readable(message) {
  if (typeof message.data === "string") return message.data;
  return json(message, 1).replace(/["{},]/g, "").replace(/\n\s*(?=\n|$)/g, "").replace(/^\n/, "").replace(/^ /gm, "");
}
