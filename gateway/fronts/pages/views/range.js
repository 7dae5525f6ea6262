// SPDX-License-Identifier: Apache-2.0
import { element } from "../shared/dom.js";
import { insist, Plan } from "./plan.js";

const KINDS = ["ultrasound", "infrared"]; // Range.ULTRASOUND and INFRARED
const HERE = { x: 0, y: 0, yaw: 0 };
const STEPS = 16; // of an arc

/** The distance that one sensor measures, in words and as its beam: forward is up. */
export class RangeView {
  static title = "Range";
  static types = ["sensor_msgs/msg/Range"];

  options = { throttle_rate: 50 };
  #plan;
  #value = element("strong", { className: "big" });
  #about = element("p", { className: "quiet" });

  constructor(card) {
    this.#plan = new Plan(`beam of ${card.topic}, seen from above`);
    this.element = element("div", { className: "noted" }, this.#value, this.#about, this.#plan.element);
  }

  show({ range, min_range: least, max_range: most, field_of_view: angle, radiation_type: kind }) {
    this.#value.textContent = wordsOf(range, least, most);
    this.#about.textContent = `${KINDS[kind] ?? `radiation type ${kind}`} · ${least.toFixed(2)} to ${most.toFixed(2)} m · ${((angle * 180) / Math.PI).toFixed(0)}° wide`;
    insist(least, most, angle);
    this.#plan.begin(HERE, Math.max(most, 0.1), 0);
    this.#plan.rings(HERE, Math.max(most, 0.1));
    this.#plan.line(beam(angle, most), "line");
    if (range >= least && range <= most) this.#plan.line(beam(angle, range));
    this.#plan.robot(HERE);
  }
}

/** Return a range in words, as REP 117 has it. Some sensors have only one: then infinity, or the end of the range, is nothing. */
function wordsOf(range, least, most) {
  if (Number.isNaN(range)) return "not measured";
  if (range < least) return `closer than ${least.toFixed(2)} m`;
  if (range > most) return `nothing within ${most.toFixed(2)} m`;
  return `${range.toFixed(3)} m`;
}

/** Return the outline of a beam of a length. */
function beam(angle, length) {
  const arc = Array.from({ length: STEPS + 1 }, (_, index) => -angle / 2 + (angle * index) / STEPS);
  return [HERE, ...arc.map((each) => ({ x: Math.cos(each) * length, y: Math.sin(each) * length })), HERE];
}
