// SPDX-License-Identifier: Apache-2.0
// The places of the robot and its laser on a map, as far as ROS tells them.

import { say } from "../shared/language.js";
import { Arrivals } from "../shared/arrivals.js";
import { published } from "../shared/named_topics.js";
import { yawOf } from "./plan.js";

const BASES = ["base_footprint", "base_link"]; // REP 105 and REP 120. Whichever is known first is the robot
const RATE_HZ = 15;
const MISSING_MS = 2000; // so long a transform may take to come

/** The robot and the first laser scan in a frame, until it is closed. */
export class Whereabouts {
  scan = null;
  #gateway;
  #frame;
  #robot = new Place();
  #laser = new Place();
  #laserFrame = "";
  #scans; // the topic of the scan
  #sinceMs = 0; // when a transform was asked for last
  #changed;
  #ends = []; // what to call when this is closed

  /**
   * @param {import("../shared/gateway.js").Gateway} gateway
   * @param {string} frame of the map
   * @param {() => void} changed is called when there is something else to draw
   */
  constructor(gateway, frame, changed) {
    this.#gateway = gateway;
    this.#frame = frame;
    this.#changed = changed;
    let known = "";
    for (const base of BASES) {
      this.#follow(base, (transform) => {
        known ||= base;
        if (base === known) this.#robot.take(transform);
      });
    }
    this.#scans = published(gateway.graph, "scan");
    if (this.#scans) this.#ends.push(gateway.subscribe(this.#scans, { compression: "cbor" }, (each) => this.#scanned(each), () => {}));
  }

  /** The pose of the robot, or null. */
  get robot() {
    return this.#robot.pose;
  }

  /** The pose of what scans, or null. */
  get laser() {
    return this.#laser.pose;
  }

  /** The arrivals of the transforms: to the robot, or to its laser if only those are late. */
  get arrivals() {
    return this.#laser.arrivals.isLate && !this.#robot.arrivals.isLate ? this.#laser.arrivals : this.#robot.arrivals;
  }

  /** Whether the scan or a transform stays away, and with it what moves the robot. */
  get isLate() {
    return Boolean(this.arrivals.isLate || this.#gateway.arrivals.get(this.#scans)?.isLate);
  }

  /** Which transforms are missing, in words, or "". */
  get missing() {
    if (performance.now() - this.#sinceMs < MISSING_MS) return "";
    const words = [];
    if (!this.robot) words.push(say("where.robot", this.#between(say("where.either", { first: BASES[0], second: BASES[1] }))));
    if (this.scan && !this.laser) words.push(say("where.scan", this.#between(this.#laserFrame)));
    return words.join(" ");
  }

  close() {
    for (const end of this.#ends) end();
  }

  /** Return the names of a frame and of that of the map. */
  #between(frame) {
    return { frame: frame || say("where.nameless"), map: this.#frame || say("where.frameless") };
  }

  #scanned(scan) {
    this.scan = scan;
    this.#changed();
    if (scan.header.frame_id === this.#laserFrame) return;
    this.#laserFrame = scan.header.frame_id;
    const laser = new Place();
    this.#laser = laser;
    this.#follow(this.#laserFrame, (transform) => laser.take(transform));
  }

  #follow(frame, take) {
    this.#sinceMs = performance.now();
    const end = this.#gateway.followTransform(this.#frame, frame, RATE_HZ, (transform) => {
      take(transform);
      this.#changed();
    });
    this.#ends.push(end);
  }
}

/** A pose, and when it was last said: the gateway repeats it with each stamp, and sends a fixed one once. */
class Place {
  pose = null;
  arrivals = new Arrivals();

  take({ translation: { x, y }, rotation }) {
    this.pose = { x, y, yaw: yawOf(rotation) };
    this.arrivals.add(0, 0);
  }
}
