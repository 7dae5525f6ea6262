// SPDX-License-Identifier: Apache-2.0
// The speed of the robot and its battery, in a line over the camera.

import { say } from "../shared/language.js";
import { published } from "../shared/named_topics.js";

const OLD_MS = 2000; // of the speed
const OLD_CHARGE_MS = 30_000; // a battery is measured now and then
const LOW = 0.2;

/** Writes a line. */
export class Readout {
  #gateway;
  #element;
  #twist = null;
  #twistMs = 0;
  #battery = null;
  #batteryMs = 0;
  #topic = "";

  /**
   * @param {import("../shared/gateway.js").Gateway} gateway
   * @param {HTMLElement} element
   */
  constructor(gateway, element) {
    this.#gateway = gateway;
    this.#element = element;
  }

  /** Subscribe to the battery, once there is one. */
  look() {
    if (this.#topic) return;
    this.#topic = published(this.#gateway.graph, "battery");
    if (!this.#topic) return;
    this.#gateway.subscribe(this.#topic, { throttle_rate: 1000 }, (message) => {
      this.#battery = message;
      this.#batteryMs = performance.now();
    }, () => {});
  }

  /** Take a `nav_msgs/msg/Odometry`. */
  odometry({ twist: { twist } }) {
    this.#twist = twist;
    this.#twistMs = performance.now();
  }

  /** Write what is known and new. */
  write() {
    const now = performance.now();
    const parts = [];
    if (this.#twist && now - this.#twistMs < OLD_MS) parts.push(speed(this.#twist));
    const charge = this.#battery && now - this.#batteryMs < OLD_CHARGE_MS ? chargeOf(this.#battery) : "";
    if (charge) parts.push(charge);
    const words = parts.join(" · ");
    if (this.#element.textContent !== words) this.#element.textContent = words;
    this.#element.classList.toggle("low", Boolean(charge) && this.#battery.percentage < LOW);
  }
}

function speed({ linear, angular }) {
  if (![linear.x, linear.y, angular.z].every(Number.isFinite)) return say("readout.unknown");
  const sideways = Math.abs(linear.y) >= 0.005 ? `, ${say("readout.left", { speed: linear.y.toFixed(2) })}` : "";
  return `${fixed(linear.x)} m/s${sideways}, ${fixed(angular.z)} rad/s`;
}

/** Return a number with two digits. None is 0, a little before and after. */
const fixed = (value) => (Math.abs(value) < 0.005 ? 0 : value).toFixed(2);

/** Return the charge in words, or else the voltage, or "". */
function chargeOf({ percentage, voltage }) {
  const charge = `${Math.round(percentage * 100)} %`;
  if (percentage >= 0 && percentage <= 1) return percentage < LOW ? say("readout.low", { charge }) : say("readout.charge", { charge });
  return Number.isFinite(voltage) ? say("readout.charge", { charge: `${voltage.toFixed(1)} V` }) : "";
}
