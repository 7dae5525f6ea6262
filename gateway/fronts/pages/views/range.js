// SPDX-License-Identifier: Apache-2.0
import { element } from "../shared/dom.js";
import { say } from "../shared/language.js";
import { insist, Plan } from "./plan.js";

const KINDS = ["ultrasound", "infrared"]; // Range.ULTRASOUND and INFRARED
const HERE = { x: 0, y: 0, yaw: 0 };
const STEPS = 16; // of an arc

/** The distance that one sensor measures, in words and as its beam: forward is up. */
export class RangeView {
  static title = say("view.range");
  static types = ["sensor_msgs/msg/Range"];

  options = { throttle_rate: 50 };
  #plan;
  #value = element("strong", { className: "big" });
  #about = element("p", { className: "quiet" });

  constructor(card) {
    this.#plan = new Plan(say("range.label", { topic: card.topic }));
    this.element = element("div", { className: "noted" }, this.#value, this.#about, this.#plan.element);
  }

  show({ range, min_range: least, max_range: most, field_of_view: angle, radiation_type: kind }) {
    this.#value.textContent = wordsOf(range, least, most);
    this.#about.textContent = [say(`range.kind.${KINDS[kind] ?? "other"}`, { kind }), say("range.ends", { least: least.toFixed(2), most: most.toFixed(2) }), say("range.wide", { degrees: ((angle * 180) / Math.PI).toFixed(0) })].join(" · ");
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
  if (Number.isNaN(range)) return say("unmeasured");
  if (range < least) return say("range.closer", { least: least.toFixed(2) });
  if (range > most) return say("range.nothing", { most: most.toFixed(2) });
  return `${range.toFixed(3)} m`;
}

/** Return the outline of a beam of a length. */
function beam(angle, length) {
  const arc = Array.from({ length: STEPS + 1 }, (_, index) => -angle / 2 + (angle * index) / STEPS);
  return [HERE, ...arc.map((each) => ({ x: Math.cos(each) * length, y: Math.sin(each) * length })), HERE];
}
