// SPDX-License-Identifier: Apache-2.0
import { element } from "../shared/dom.js";

const STATUS = ["status unknown", "charging", "discharging", "not charging", "full"]; // POWER_SUPPLY_STATUS_*
const HEALTH = ["", "good", "overheated", "dead", "overvoltage", "unspecified failure", "cold", "watchdog expired", "safety timer expired"];
const LOW = 0.2;

/** A battery in words and as a bar. */
export class BatteryView {
  static title = "Battery";
  static types = ["sensor_msgs/msg/BatteryState"];

  options = { throttle_rate: 500 };
  element = element("div", { className: "battery" });
  #meter = element("meter", { min: 0, max: 1, low: LOW, high: LOW, optimum: 1, aria: { label: "charge" } });
  #share = element("strong");
  #rest = element("p");

  constructor() {
    this.element.append(this.#share, this.#meter, this.#rest);
  }

  show({ percentage, voltage, current, temperature, power_supply_status: status, power_supply_health: health }) {
    const share = measured(percentage);
    this.#share.textContent = charge(share);
    this.#meter.hidden = !isShare(share);
    this.#meter.value = share ?? 0;
    const parts = [[voltage, "V"], [current, "A"], [temperature, "°C"]]
      .map(([value, unit]) => [measured(value), unit])
      .filter(([value]) => value !== null)
      .map(([value, unit]) => `${value.toFixed(1)} ${unit}`);
    this.#rest.textContent = [STATUS[status] ?? `status ${status}`, HEALTH[health] ?? `health ${health}`, ...parts].filter(Boolean).join(" · ");
  }
}

/** Whether it is what the type asks for: a charge as a share of 1. */
const isShare = (value) => value !== null && value >= 0 && value <= 1;

function charge(share) {
  if (share === null) return "charge not measured";
  if (!isShare(share)) return `charge ${share}: out of range (0 to 1)`;
  return `${Math.round(share * 100)} %${share < LOW ? ", low" : ""}`;
}

/** Return a number, or null for NaN, which stands for what is not measured. */
const measured = (value) => (Number.isFinite(value) ? value : null);
