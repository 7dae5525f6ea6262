// SPDX-License-Identifier: Apache-2.0
import { say } from "../shared/language.js";
import { isHit, Plan } from "./plan.js";

const HERE = { x: 0, y: 0, yaw: 0 };

/** A laser scan from above: forward, the x of its frame, is up. */
export class ScanView {
  static title = say("view.scan");
  static types = ["sensor_msgs/msg/LaserScan"];

  options = { compression: "cbor", throttle_rate: 50 };
  #plan;

  constructor(card) {
    this.#plan = new Plan(say("scan.label", { topic: card.topic }));
    this.element = this.#plan.element;
  }

  show(scan) {
    const { ranges, range_min: least, range_max: most } = scan;
    if (!Number.isFinite(scan.angle_min + scan.angle_increment)) throw new RangeError(say("scan.number"));
    const farthest = ranges.reduce((far, each) => (isHit(each, least, most) ? Math.max(far, each) : far), 1);
    this.#plan.begin(HERE, farthest, HERE.yaw);
    this.#plan.rings(HERE, farthest);
    this.#plan.scan(scan, HERE);
    this.#plan.robot(HERE);
  }
}
