// SPDX-License-Identifier: Apache-2.0
import { element, span } from "../../shared/dom.js";
import { isRefusal, sendGoal } from "../../shared/goal.js";
import { json } from "../../shared/json.js";
import { say } from "../../shared/language.js";
import { isHeld } from "../../shared/stop_held.js";
import { Form } from "../forms/form.js";
import { FormCard, NOT_CONNECTED } from "./form_card.js";

const STATUS = { 4: "succeeded", 5: "canceled", 6: "aborted" }; // of action_msgs/msg/GoalStatus

/** A form that sends a goal to an action, its feedback and its result. STOP and closing it cancel the goal. */
export class GoalCard extends FormCard {
  #cancel = element("button", { type: "button", disabled: true }, say("cancel"));
  #feedback = element("pre", { className: "raw", role: "group", aria: { live: "off", label: say("goal.feedback") } });
  #result = element("pre", { className: "raw", role: "status", aria: { label: say("goal.result") } });
  /** The one on its way. @type {import("../../shared/goal.js").Goal|null} */
  #goal = null;
  #beganMs = 0;
  #ignore = () => {};

  constructor(gateway, shown, actions) {
    super(gateway, shown, actions, { kind: "goal", typeOf: () => gateway.graph.actions.get(shown.topic)?.types[0] ?? "" });
    this.#cancel.onclick = () => this.#goal?.cancel();
    this.buttons.append(this.#cancel);
    this.body.append(this.#feedback, this.#result);
    this.#ignore = gateway.on("state", () => this.#end(say("goal.lost")));
  }

  formOf({ schema }) {
    return new Form({ ...schema.properties.goal, $defs: schema.$defs });
  }

  submit() {
    if (isHeld()) throw new Error(say("stop.held"));
    if (this.#goal) throw new Error(say("goal.already"));
    const args = this.form.json();
    this.tell("");
    this.#feedback.textContent = this.#result.textContent = "";
    this.#goal = sendGoal(this.gateway, { action: this.topic, action_type: this.type, nonfinite: "string" }, { args }, (frame) => this.#heard(frame));
    if (!this.#goal) {
      this.tell(NOT_CONNECTED);
      return;
    }
    this.#beganMs = performance.now();
    this.#cancel.disabled = false;
    this.footer.textContent = say("goal.progress");
  }

  close() {
    this.#goal?.cancel();
    this.#goal?.end();
    this.#ignore();
    super.close();
  }

  #heard(frame) {
    const { op, values, status, result, msg } = frame;
    if (op === "action_feedback") write(this.#feedback, json(values, 2));
    else if (isRefusal(frame)) this.#end(msg);
    else if (op === "status") this.tell(msg);
    else if (op === "action_result") {
      write(this.#result, result ? json(values, 2) : "");
      this.#end(result ? "" : String(values));
      this.footer.textContent = say(`goal.${STATUS[status] ?? "undone"}`, { span: span(performance.now() - this.#beganMs) });
    }
  }

  #end(problem) {
    if (!this.#goal) return;
    this.#goal.end();
    this.#goal = null;
    this.#cancel.disabled = true;
    this.footer.textContent = "";
    this.tell(problem);
  }
}

/** Write the progress of a goal, and bring it into view at first, because it stands below the fields. */
function write(place, text) {
  const isFirst = !place.textContent;
  place.textContent = text;
  if (isFirst && text) place.scrollIntoView({ block: "nearest" });
}
