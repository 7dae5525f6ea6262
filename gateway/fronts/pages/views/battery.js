// SPDX-License-Identifier: Apache-2.0
import { element } from "../shared/dom.js";
import { say } from "../shared/language.js";

const STATUS = ["unknown", "charging", "discharging", "not_charging", "full"]; // POWER_SUPPLY_STATUS_*
const HEALTH = ["unknown", "good", "overheated", "dead", "overvoltage", "failure", "cold", "watchdog", "timer"]; // POWER_SUPPLY_HEALTH_*
const LOW = 0.2;

/** A battery in words and as a bar. */
export class BatteryView {
  static title = say("view.battery");
  static types = ["sensor_msgs/msg/BatteryState"];

  options = { throttle_rate: 500 };
  element = element("div", { className: "battery" });
  #meter = element("meter", { min: 0, max: 1, low: LOW, high: LOW, optimum: 1, aria: { label: say("battery.charge") } });
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
    this.#rest.textContent = [say(`battery.status.${STATUS[status] ?? "other"}`, { status }), say(`battery.health.${HEALTH[health] ?? "other"}`, { health }), ...parts].filter(Boolean).join(" · ");
  }
}

/** Whether it is what the type asks for: a charge as a share of 1. */
const isShare = (value) => value !== null && value >= 0 && value <= 1;

function charge(share) {
  if (share === null) return say("battery.unmeasured");
  if (!isShare(share)) return say("battery.beyond", { share });
  const charge = `${Math.round(share * 100)} %`;
  return share < LOW ? say("battery.low", { charge }) : charge;
}

/** Return a number, or null for NaN, which stands for what is not measured. */
const measured = (value) => (Number.isFinite(value) ? value : null);
