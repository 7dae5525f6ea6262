// SPDX-License-Identifier: Apache-2.0
import * as bar from "../../shared/bar.js";
import { CommandTopic } from "../../shared/command_topic.js";
import { element } from "../../shared/dom.js";
import { Driver } from "../../shared/driver.js";
import { say } from "../../shared/language.js";
import { watch } from "../../shared/held.js";
import { Card } from "./card.js";

const MOST_M_S = 0.2; // of the drive page's sliders, where they begin
const MOST_RAD_S = 0.8;

/** A stick that drives a robot while it is held: by a finger, the mouse or, while it has the focus, arrow keys. */
export class DriveCard extends Card {
  #words = element("p", { className: "control", role: "status" });
  #stick;
  #take;
  #command;
  #held;
  #forgets;

  constructor(gateway, shown, actions) {
    const title = say("drive.card", { topic: shown.topic });
    super(gateway, shown, actions, { title });
    const knob = element("div", { className: "knob" });
    const stick = element("div", { className: "stick", tabIndex: 0, aria: { label: say("drive.stick.of", { topic: this.topic }) } }, knob);
    stick.setAttribute("role", "application");
    this.#stick = stick;
    this.#take = element("button", { type: "button", hidden: true, aria: { label: say("drive.take.of", { topic: this.topic }) } }, say("drive.take"));
    this.#command = new CommandTopic(gateway, () => this.#write(), this.topic);
    const driver = new Driver(({ linear, angular }) => this.#command.publish(linear * MOST_M_S, angular * MOST_RAD_S));
    this.#take.onclick = () => this.#takeOver(driver);
    bar.stopBySpace({ where: stick });
    this.#held = watch(stick, knob, (linear, angular) => driver.hold(linear, angular), stick);
    this.#forgets = ["state", "stopping"].map((each) => gateway.on(each, this.#held.letGo)); // a key that was held before belongs to another connection
    this.body.append(stick, this.#words, this.#take); // below: what is said moves no stick that is held
    this.footer.textContent = say("drive.limit", { linear: MOST_M_S, angular: MOST_RAD_S });
    this.#write();
  }

  rest() {
    super.rest();
    this.#held.letGo();
  }

  close() {
    this.#held.end();
    for (const forget of this.#forgets) forget();
    this.#command.close();
    super.close();
  }

  async #takeOver(driver) {
    try {
      await this.#command.acquire();
      driver.ready();
      this.tell("");
    } catch (error) {
      this.tell(error.message);
    }
  }

  #write() {
    const words = this.#command?.words ?? "";
    if (this.#words.textContent !== words) this.#words.textContent = words; // it is read out
    if (this.#command) bar.review(this.#command);
    if (!this.#command?.isFree) this.#held?.letGo(); // it has to be pressed again
    const { state = null, isForbidden = false } = this.#command ?? {};
    this.#stick.setAttribute("aria-disabled", String(isForbidden || !state)); // as it moves nothing
    this.#take.hidden = isForbidden || state?.holder !== "other";
  }
}
