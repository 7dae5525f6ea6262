// SPDX-License-Identifier: Apache-2.0
import { element } from "../shared/dom.js";
import { say } from "../shared/language.js";
import { Pairs } from "./pairs.js";
import { Plan } from "./plan.js";
import { Trail } from "./trail.js";

const NO_FIX = -1;
const STATUS = { "-2": "unknown", "-1": "none", 0: "fix", 1: "SBAS", 2: "GBAS" }; // NavSatStatus
const EARTH = 6_371_008.8; // metres: its mean radius
const RADIANS = Math.PI / 180;
const MOST_ERROR = 1000; // metres, of a circle that is drawn

/** The way of a satellite receiver in metres from its first fix: east is right, north is up. */
export class FixView {
  static title = say("view.fix");
  static types = ["sensor_msgs/msg/NavSatFix"];

  options = { throttle_rate: 50 };
  #plan;
  #trail = new Trail();
  #values = new Pairs();
  #first = null;
  #error = NaN; // metres

  constructor(card) {
    this.#plan = new Plan(say("fix.label", { topic: card.topic }));
    this.element = element("div", { className: "noted" }, this.#values.element, this.#plan.element);
  }

  keep({ latitude, longitude, status, position_covariance: covariance, position_covariance_type: kind }) {
    if (status.status === NO_FIX || !Number.isFinite(latitude + longitude)) return;
    this.#first ??= { latitude, longitude };
    this.#error = kind ? Math.sqrt(Math.max(covariance[0], covariance[4])) : NaN; // 0: unknown
    this.#trail.extend({ ...planeOf(this.#first, { latitude, longitude }), yaw: 0 });
  }

  show({ latitude, longitude, altitude, status }) {
    const { pose } = this.#trail;
    if (pose) {
      this.#trail.draw(this.#plan);
      this.#plan.circle(pose, Math.min(MOST_ERROR, this.#error) || 0);
    }
    this.#values.show([
      [say("fix.status"), say(`fix.status.${STATUS[status.status] ?? "other"}`, { status: status.status })],
      [say("fix.latitude"), degrees(latitude, "N", "S")],
      [say("fix.longitude"), degrees(longitude, "E", "W")],
      [say("fix.altitude"), Number.isFinite(altitude) ? `${altitude.toFixed(1)} m` : say("unmeasured")],
      [say("fix.from"), pose ? say("fix.way", { east: pose.x.toFixed(2), north: pose.y.toFixed(2) }) : say("fix.not_yet")],
      [say("fix.accuracy"), this.#error > 0 ? `${this.#error.toFixed(2)} m` : say("fix.status.unknown")],
    ]);
  }
}

/** Return a place in metres from another one, east and north of it: on a plane, as nearby. */
function planeOf(first, { latitude, longitude }) {
  const turn = ((longitude - first.longitude + 540) % 360) - 180; // also across the date line
  return { x: turn * RADIANS * EARTH * Math.cos(first.latitude * RADIANS), y: (latitude - first.latitude) * RADIANS * EARTH };
}

const degrees = (value, positive, negative) => (Number.isFinite(value) ? `${Math.abs(value).toFixed(7)}° ${value < 0 ? negative : positive}` : say("unmeasured"));
