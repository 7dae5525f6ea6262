// SPDX-License-Identifier: Apache-2.0
// Which topics the lab shows: the first that somebody publishes of each kind, once there is one.

import { json } from "../shared/json.js";
import { lasting } from "../shared/passing.js";
import { Placement } from "./placement.js";

const ODOMETRY = ["nav_msgs/msg/Odometry"];
const SCANS = ["sensor_msgs/msg/LaserScan"];
const IMAGES = ["sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"];
const MAPS = ["nav_msgs/msg/OccupancyGrid"];
const LOGS = ["rcl_interfaces/msg/Log"];
const FAVOURITES = ["sensor_msgs/msg/BatteryState", "std_msgs/msg/String"]; // for the screen that shows any topic
const FAST_MS = 33;
const SLOW_MS = 250;
const MAP_MS = 1000; // a map that grows is drawn as a whole
const MAP_HZ = 5; // of its place: odometry drifts slowly, and jumps when the robot finds itself
const LASER_HZ = 1; // of its place: it is screwed on

/** Subscriptions of the lab. */
export class Sources {
  #gateway;
  #tell;
  #known = new Map(); // kind -> topic
  #parts;
  #map; // where its frame is to the odometry's
  #laser; // where it is on the robot

  /**
   * @param {import("../shared/gateway.js").Gateway} gateway
   * @param {(words: string) => void} tell
   * @param {{twin: import("./twin.js").Twin, map: import("./floor_map.js").FloorMap}} parts
   */
  constructor(gateway, tell, parts) {
    this.#gateway = gateway;
    this.#tell = tell;
    this.#parts = parts;
    this.#map = new Placement(gateway, "the map is hidden, and no target is checked by it", MAP_HZ, (transform) => parts.map.place(transform));
    this.#laser = new Placement(gateway, "the scan is hidden", LASER_HZ, (transform) => parts.twin.mount(transform));
  }

  /** What is not shown as nobody knows where it is, in words, or "". */
  get missing() {
    return [this.#map.words, this.#laser.words].filter(Boolean).join("\n");
  }

  /** Subscribe to what has come: call it after each change of the graph. */
  watch({ pilot, motion, television, log, logged }) {
    const { twin, map } = this.#parts;
    this.#first("odometry", ODOMETRY, { compression: "cbor", throttle_rate: FAST_MS }, (message) => {
      twin.odometry(message);
      pilot.odometry(twin.pose);
      motion.odometry(message);
      this.#map.within(message.header.frame_id);
      this.#laser.within(message.child_frame_id);
    });
    this.#first("map", MAPS, { compression: "cbor", throttle_rate: MAP_MS }, (message) => {
      try {
        map.take(message);
      } catch (error) {
        this.#tell(`this map cannot be shown: ${error.message}`);
      }
      this.#map.of(message.header.frame_id);
    });
    this.#first("scan", SCANS, { compression: "cbor", throttle_rate: 100 }, (message) => {
      twin.scan(message);
      this.#laser.of(message.header.frame_id);
    });
    this.#first("camera", IMAGES, television.options, (message) => television.show(message));
    this.#first("log", LOGS, {}, (line) => {
      log.add(`${line.name}: ${line.msg}`);
      logged(line);
    });
  }

  /** Return what has come of a kind, or undefined. */
  arrivals(kind) {
    return this.#gateway.arrivals.get(this.#known.get(kind));
  }

  /** Return the topics that a screen can show as text; pictures are none. */
  get readable() {
    return [...this.#gateway.graph.topics.values()]
      .filter(({ publishers, types }) => publishers.length && !IMAGES.includes(types[0]))
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

  /** Show a topic on a screen as text; return what ends that. */
  read(topic, screen) {
    screen.show(topic, "nothing yet");
    return this.#gateway.subscribe(
      topic, { throttle_rate: SLOW_MS },
      (message) => screen.show(topic, readable(message)),
      lasting(this.#tell),
    );
  }

  #first(kind, types, options, onMessage) {
    const topic = !this.#known.has(kind) && this.#gateway.graph.published(...types);
    if (!topic) return;
    this.#known.set(kind, topic.name);
    this.#gateway.subscribe(topic.name, options, onMessage, lasting(this.#tell));
  }
}

/** Return a message as text for people: a string as it is, the rest without what only programs need. */
function readable(message) {
  if (typeof message.data === "string") return message.data;
  return json(message, 1).replace(/["{},]/g, "").replace(/\n\s*(?=\n|$)/g, "").replace(/^\n/, "").replace(/^ /gm, "");
}
