// SPDX-License-Identifier: Apache-2.0
import { element, span } from "../../shared/dom.js";
import { json } from "../../shared/json.js";
import { say } from "../../shared/language.js";
import { Form } from "../forms/form.js";
import { FormCard } from "./form_card.js";

/** A form that calls a service, and its answer. */
export class CallCard extends FormCard {
  #answer = element("pre", { className: "raw", aria: { live: "polite" } });
  #calls = 0;

  constructor(gateway, shown, actions) {
    super(gateway, shown, actions, { kind: "call", typeOf: () => gateway.graph.services.get(shown.topic)?.types[0] ?? "" });
    this.body.append(this.#answer);
  }

  formOf({ schema }) {
    return new Form({ ...schema.properties.request, $defs: schema.$defs });
  }

  submit() {
    this.#call(this.form.json());
  }

  /** Call, and show the answer unless a newer call has been made since: answers come in any order. */
  async #call(args) {
    this.#calls += 1;
    const number = this.#calls;
    const report = (words) => (this.footer.textContent = number > 1 ? say("call.number", { number, words }) : words);
    this.tell("");
    this.#answer.textContent = "";
    report(say("call.waiting"));
    const began = performance.now();
    const { text = "", problem = "" } = await this.#answerTo(args);
    if (number !== this.#calls) return;
    this.#answer.textContent = text;
    this.tell(problem);
    report(say("call.after", { span: span(performance.now() - began) }));
  }

  async #answerTo(args) {
    try {
      const { result, values } = await this.gateway.ask({ op: "call_service", service: this.topic, type: this.type, nonfinite: "string" }, { args });
      return result ? { text: json(values, 2) } : { problem: String(values) };
    } catch (error) {
      return { problem: error.message };
    }
  }
}
