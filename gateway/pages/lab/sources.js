// SPDX-License-Identifier: Apache-2.0
// Which topics the lab shows: the first that somebody publishes of each kind, once there is one.

import { json } from "../shared/json.js";
import { lasting } from "../shared/passing.js";

const ODOMETRY = ["nav_msgs/msg/Odometry"];
const SCANS = ["sensor_msgs/msg/LaserScan"];
const IMAGES = ["sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"];
const MAPS = ["nav_msgs/msg/OccupancyGrid"];
const LOGS = ["rcl_interfaces/msg/Log"];
const FAVOURITES = ["sensor_msgs/msg/BatteryState", "std_msgs/msg/String"]; // for the screen that shows any topic
const HERE = { translation: { x: 0, y: 0, z: 0 }, rotation: { x: 0, y: 0, z: 0, w: 1 } };
const FAST_MS = 33;
const SLOW_MS = 250;
const MAP_MS = 1000; // a map that grows is drawn as a whole
const MAP_HZ = 5; // of its place: odometry drifts slowly, and jumps when the robot finds itself

/** Subscriptions of the lab. */
export class Sources {
  #gateway;
  #tell;
  #known = new Map(); // kind -> topic
  #frame = ""; // of the scan
  #odometryFrame = "";
  #mapFrame = "";

  constructor(gateway, tell) {
    this.#gateway = gateway;
    this.#tell = tell;
  }

  /** Subscribe to what has come: call it after each change of the graph. */
  watch({ pilot, twin, motion, map, television, log, logged }) {
    this.#first("odometry", ODOMETRY, { compression: "cbor", throttle_rate: FAST_MS }, (message) => {
      twin.odometry(message);
      pilot.odometry(twin.pose);
      motion.odometry(message);
      this.base = message.child_frame_id;
      this.#spread(message.header.frame_id, this.#mapFrame, map);
    });
    this.#first("map", MAPS, { compression: "cbor", throttle_rate: MAP_MS }, (message) => {
      try {
        map.take(message);
      } catch (error) {
        this.#tell(`this map cannot be shown: ${error.message}`);
      }
      this.#spread(this.#odometryFrame, message.header.frame_id, map);
    });
    this.#first("scan", SCANS, { compression: "cbor", throttle_rate: 100 }, (message) => {
      twin.scan(message);
      this.#mount(message.header.frame_id, twin);
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

  #mount(frame, twin) {
    if (!this.base || frame === this.#frame) return;
    this.#frame = frame;
    this.#end?.();
    this.#end = this.#gateway.followTransform(this.base, frame, 1, (transform) => twin.mount(transform));
  }

  #end = null;

  /** Lay the map where its frame is to the odometry's. */
  #spread(odometry, frame, map) {
    if (odometry === this.#odometryFrame && frame === this.#mapFrame) return;
    [this.#odometryFrame, this.#mapFrame] = [odometry, frame];
    this.#endMap?.();
    this.#endMap = null;
    map.place(frame === odometry ? HERE : null);
    if (odometry && frame && frame !== odometry) this.#endMap = this.#gateway.followTransform(odometry, frame, MAP_HZ, (transform) => map.place(transform));
  }

  #endMap = null;
}

/** Return a message as text for people: a string as it is, the rest without what only programs need. */
function readable(message) {
  if (typeof message.data === "string") return message.data;
  return json(message, 1).replace(/["{},]/g, "").replace(/\n\s*(?=\n|$)/g, "").replace(/^\n/, "").replace(/^ /gm, "");
}
