// SPDX-License-Identifier: Apache-2.0
import { element, span } from "../../shared/dom.js";
import { json } from "../../shared/json.js";
import { Form } from "../forms/form.js";
import { FormCard } from "./form_card.js";

/** A form that calls a service, and its answer. */
export class CallCard extends FormCard {
  #answer = element("pre", { className: "raw", aria: { live: "polite" } });

  constructor(gateway, shown, actions) {
    super(gateway, shown, actions, { verb: "Call", title: `Call ${shown.topic}`, type: gateway.graph.services.get(shown.topic)?.types[0] ?? "" });
    this.body.append(this.#answer);
  }

  formOf({ schema }) {
    return new Form({ ...schema.properties.request, $defs: schema.$defs });
  }

  submit() {
    this.#call(this.form.json());
  }

  async #call(args) {
    this.tell("");
    this.footer.textContent = "waiting for the answer ...";
    const began = performance.now();
    try {
      const { result, values } = await this.gateway.ask({ op: "call_service", service: this.topic, nonfinite: "string" }, { args });
      this.#answer.textContent = result ? json(values, 2) : "";
      if (!result) this.tell(String(values));
    } catch (error) {
      this.tell(error.message);
    }
    this.footer.textContent = `after ${span(performance.now() - began)}`;
  }
}
