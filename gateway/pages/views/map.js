// SPDX-License-Identifier: Apache-2.0
import { draw } from "./occupancy.js";
import { insist, Plan, yawOf } from "./plan.js";

const BASES = ["base_footprint", "base_link"]; // REP 105 and REP 120; whichever is known first is the robot
const RATE_HZ = 15;
const SCAN = "sensor_msgs/msg/LaserScan";

/** A map with the robot and the first laser scan in it, as far as ROS knows where they are. */
export class MapView {
  options = { compression: "cbor" };
  #card;
  #plan;
  #map = null; // {canvas, origin, resolution, middle, reach}
  #frame = "";
  #robot = null;
  #scan = null;
  #laser = null; // the pose of what scans
  #laserFrame = "";
  #scans = ""; // the topic of the scan
  #isOld = false; // whether the scan has stayed away, and with it what moves the robot
  #isDirty = false;
  #ends = []; // what to call when this is closed

  constructor(card) {
    this.#card = card;
    this.#plan = new Plan(`map of ${card.topic}, seen from above`);
    this.element = this.#plan.element;
  }

  show(message) {
    try {
      this.#map = placed(message);
    } catch (error) {
      this.#card.tell(`this map cannot be shown: ${error.message}`);
      return;
    }
    this.#isDirty = true;
    const frame = message.header.frame_id;
    if (frame !== this.#frame) this.#watch(frame);
  }

  /** Draw what has changed. */
  draw() {
    const isOld = Boolean(this.#card.gateway.arrivals.get(this.#scans)?.isLate);
    this.#isDirty ||= isOld !== this.#isOld;
    this.#isOld = isOld;
    if (!this.#isDirty || !this.#map) return;
    this.#isDirty = false;
    const { canvas, origin, resolution, middle, reach } = this.#map;
    this.#plan.begin(middle, reach);
    this.#plan.image(canvas, origin, resolution);
    this.#plan.grid();
    const old = isOld ? "quiet" : undefined;
    if (this.#scan && this.#laser) this.#plan.scan(this.#scan, this.#laser, old);
    if (this.#robot) this.#plan.robot(this.#robot, old);
  }

  close() {
    for (const end of this.#ends) end();
    this.#ends = [];
  }

  #watch(frame) {
    this.close();
    this.#frame = frame;
    this.#laserFrame = "";
    this.#robot = this.#laser = null;
    let known = "";
    for (const base of BASES) {
      this.#follow(base, (pose) => {
        known ||= base;
        if (base === known) this.#robot = pose;
      });
    }
    this.#scans = this.#card.gateway.graph.published(SCAN)?.name ?? "";
    if (this.#scans) this.#ends.push(this.#card.gateway.subscribe(this.#scans, { compression: "cbor" }, (each) => this.#scanned(each), () => {}));
  }

  #scanned(scan) {
    this.#scan = scan;
    this.#isDirty = true;
    if (scan.header.frame_id === this.#laserFrame) return;
    this.#laserFrame = scan.header.frame_id;
    this.#follow(this.#laserFrame, (pose) => (this.#laser = pose));
  }

  #follow(frame, take) {
    const end = this.#card.gateway.followTransform(this.#frame, frame, RATE_HZ, ({ translation: { x, y }, rotation }) => {
      take({ x, y, yaw: yawOf(rotation) });
      this.#isDirty = true;
    });
    this.#ends.push(end);
  }
}

/** Return what there is to draw of a map, and which part of the world it covers. */
function placed(message) {
  const { canvas, cells } = draw(message);
  const { resolution, width, height, origin } = message.info;
  const [x, y, yaw] = [origin.position.x, origin.position.y, yawOf(origin.orientation)];
  const [wide, high] = [width * resolution, height * resolution];
  if (!(wide > 0 && high > 0 && Number.isFinite(wide + high + x + y))) throw new RangeError(`its cells are ${resolution} m wide`);
  insist(x, y, wide, high);
  const turned = (right, up) => ({ x: x + Math.cos(yaw) * right - Math.sin(yaw) * up, y: y + Math.sin(yaw) * right + Math.cos(yaw) * up });
  const lift = (Math.ceil(height / cells) * cells - height) * resolution; // of rows that are drawn in part
  return {
    canvas,
    origin: { ...turned(0, 0), yaw },
    resolution: resolution * cells,
    middle: turned(wide / 2, high / 2 + lift / 2),
    reach: Math.max(wide, high) / 2 * (Math.abs(Math.cos(yaw)) + Math.abs(Math.sin(yaw))),
  };
}
