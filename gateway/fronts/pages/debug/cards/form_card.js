// SPDX-License-Identifier: Apache-2.0
import { element } from "../../shared/dom.js";
import { say } from "../../shared/language.js";
import { Card } from "./card.js";

export const NOT_CONNECTED = say("unconnected"); // said until there is a connection

/** A card with a form for a message, built from the gateway's description of its type. */
export class FormCard extends Card {
  /** @type {import("../forms/form.js").Form|null} */
  form = null;
  /** The type that the form is for, "" without one. */
  type = "";
  buttons = element("div", { className: "buttons" });
  #act;
  #text;
  #typeOf;
  #described = ""; // the type that was last asked for
  #missing = ""; // the words while there is no type
  #failure = ""; // why the last attempt failed
  #forgets;

  /**
   * @param {import("../../shared/gateway.js").Gateway} gateway
   * @param {import("./card.js").Shown} shown
   * @param {import("./card.js").Actions} actions
   * @param {{kind: string, typeOf: () => string}} about the kind of form, and a function that returns the described type, "" without one
   */
  constructor(gateway, shown, actions, { kind, typeOf }) {
    const [verb, title] = [say(`form.act.${kind}`), say(`form.title.${kind}`, { name: shown.topic })];
    super(gateway, shown, actions, { title });
    this.#typeOf = typeOf;
    this.#act = element("button", { type: "button", className: "act", disabled: true, aria: { label: `${verb} ${shown.topic}` } }, verb);
    this.#act.onclick = () => this.act();
    this.#text = element("button", { type: "button", title: say("form.json"), disabled: true, aria: { label: say("form.json.of", { title }) } }, "JSON");
    this.#text.onclick = () => this.#attempt(() => this.form.toggle());
    this.controls.append(this.#text);
    this.buttons.append(this.#act);
    this.body.addEventListener("input", () => this.untell(this.#failure)); // it is being mended
    this.#forgets = [gateway.on("graph", () => this.#learn()), gateway.on("state", ({ state }) => state === "open" && this.#resume())];
    this.#learn();
  }

  close() {
    for (const forget of this.#forgets) forget();
    super.close();
  }

  /**
   * Return the form for a type.
   * @abstract
   * @param {{schema: any}} described by the gateway
   * @returns {import("../forms/form.js").Form}
   */
  formOf(described) {
    throw new Error(`abstract: ${described.schema.title}`);
  }

  /**
   * Send what the form holds.
   * @abstract
   */
  submit() {}

  /** Do what the button does. Return whether that was possible. */
  act() {
    return this.#attempt(() => this.submit());
  }

  #attempt(action) {
    try {
      action();
      this.untell(this.#failure);
      return true;
    } catch (error) {
      this.#failure = error.message;
      this.tell(error.message);
      return false;
    }
  }

  /** Go on with a new connection. */
  #resume() {
    this.untell(NOT_CONNECTED);
    if (!this.form) this.#described = "";
  }

  /** Describe the type once there is one, and each that comes in its place. */
  #learn() {
    const type = this.#typeOf();
    if (type && type !== this.#described) this.#describe(type);
    if (type || this.form) return; // a form goes on with the type that there was
    this.#missing = say("form.gone", { name: this.topic });
    this.tell(this.#missing);
  }

  async #describe(type) {
    this.#described = type;
    try {
      const described = await this.gateway.ask({ op: "describe", type });
      if (type === this.#described) this.#show(type, this.formOf(described));
    } catch (error) {
      this.tell(error.message);
    }
  }

  #show(type, form) {
    const before = this.form;
    this.replaced();
    Object.assign(this, { type, form });
    this.writeType(type);
    if (before) before.element.replaceWith(form.element);
    else this.body.prepend(form.element);
    this.footer.before(this.buttons);
    this.#act.disabled = this.#text.disabled = false;
    if (before) this.tell(say("form.replaced", { name: this.topic, type }));
    else this.untell(this.#missing);
    this.actions.grown(this);
  }

  /** Called before another form takes the place of this one. */
  replaced() {}
}
