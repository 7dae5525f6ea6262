// SPDX-License-Identifier: Apache-2.0
import { element } from "../../shared/dom.js";
import { Card } from "./card.js";

/** A card with a form for a message, built from the gateway's description of its type. */
export class FormCard extends Card {
  /** @type {import("../forms/form.js").Form|null} */
  form = null;
  buttons = element("div", { className: "buttons" });
  #act;

  /**
   * @param {import("../../shared/gateway.js").Gateway} gateway
   * @param {import("./card.js").Shown} shown
   * @param {import("./card.js").Actions} actions
   * @param {{verb: string, title: string, type: string}} words what the button says, and the type that is described
   */
  constructor(gateway, shown, actions, { verb, title, type }) {
    super(gateway, shown, actions, { label: title, title, type });
    this.type = type;
    this.#act = element("button", { type: "button", className: "act", disabled: true, aria: { label: `${verb} ${shown.topic}` } }, verb);
    this.#act.onclick = () => this.act();
    const text = element("button", { type: "button", title: "write it as JSON, or in fields again", disabled: true, aria: { label: `JSON of ${title}` } }, "JSON");
    text.onclick = () => this.#attempt(() => this.form.toggle());
    this.controls.append(text);
    this.buttons.append(this.#act);
    this.#describe(text);
  }

  /**
   * Return the form for a type.
   * @abstract
   * @param {{schema: any}} described by the gateway
   * @returns {import("../forms/form.js").Form}
   */
  formOf(described) {
    throw new Error(`no form for ${described.schema.title}`);
  }

  /**
   * Send what the form holds.
   * @abstract
   */
  submit() {}

  /** Do what the button does; return whether that was possible. */
  act() {
    return this.#attempt(() => this.submit());
  }

  #attempt(action) {
    try {
      action();
      return true;
    } catch (error) {
      this.tell(error.message);
      return false;
    }
  }

  async #describe(text) {
    if (!this.type) {
      this.tell(`${this.topic} is not there (any more): nothing says which type it has.`);
      return;
    }
    try {
      const described = await this.gateway.ask({ op: "describe", type: this.type });
      this.form = this.formOf(described);
      this.body.prepend(this.form.element);
      this.footer.before(this.buttons);
      this.#act.disabled = text.disabled = false;
      this.actions.grown(this);
    } catch (error) {
      this.tell(error.message);
    }
  }
}
