// SPDX-License-Identifier: Apache-2.0
import { element } from "../../shared/dom.js";
import { Form } from "../forms/form.js";
import { FormCard, NOT_CONNECTED } from "./form_card.js";

const RATES_HZ = [1, 2, 5, 10, 20];

/** A form that publishes to a topic: once, or again and again until it is told to stop, by STOP too, or nobody looks. */
export class PublishCard extends FormCard {
  #listener;
  #timer = 0;
  #count = 0;
  #refused = 0; // of these, by the gateway
  #rates = element("select", { title: "so many messages a second" });
  #repeat = element("button", { type: "button", aria: { pressed: "false" } }, "Repeat");
  #forgets = [];
  #hide = () => this.#end("The page was hidden");

  constructor(gateway, shown, actions) {
    super(gateway, shown, actions, { verb: "Publish", title: `Publish ${shown.topic}`, typeOf: () => gateway.graph.typeOf(shown.topic) });
    this.#listener = gateway.listen((frame) => this.#heard(frame));
    this.#repeat.setAttribute("aria-label", `Repeat ${shown.topic}`);
    this.#rates.setAttribute("aria-label", `rate of ${shown.topic}`);
    for (const hz of RATES_HZ) this.#rates.append(new Option(`${hz} Hz`, String(hz)));
    this.#repeat.onclick = () => (this.#timer ? this.#stop() : this.#start());
    this.#rates.onchange = () => this.#timer && this.#start();
    this.buttons.append(this.#repeat, this.#rates);
    // what is sent into a silent connection would arrive when nobody expects it any more
    this.#forgets = [
      gateway.on("state", () => this.#end("The connection was lost")),
      gateway.on("silence", () => this.#end("The gateway did not answer")),
      gateway.on("stopping", () => this.#end("STOP was pressed")),
    ];
    document.addEventListener("visibilitychange", this.#hide);
  }

  formOf(described) {
    return new Form(described.schema);
  }

  replaced() {
    this.#stop(); // nobody has seen the message that would go on
  }

  submit() {
    this.tell("");
    const { topic, type } = this;
    const isSent = this.gateway.send({ op: "publish", id: this.#listener.id, topic, type }, { msg: this.form.json() });
    if (!isSent) throw new Error(NOT_CONNECTED);
    this.#count += 1;
    this.#write();
  }

  close() {
    this.#stop();
    this.#listener.end();
    for (const forget of this.#forgets) forget();
    document.removeEventListener("visibilitychange", this.#hide);
    super.close();
  }

  #start() {
    this.#stop();
    if (!this.act()) return;
    this.#timer = setInterval(() => this.act() || this.#stop(), 1000 / this.#rates.value);
    this.#repeat.setAttribute("aria-pressed", true);
  }

  #stop() {
    clearInterval(this.#timer);
    this.#timer = 0;
    this.#repeat.setAttribute("aria-pressed", false);
  }

  /** End what is repeated, if anything is, and say why. */
  #end(why) {
    if (!this.#timer) return;
    this.#stop();
    this.tell(`${why}: Repeat has ended.`);
  }

  #heard({ op, msg, level }) {
    if (op !== "status") return;
    this.tell(msg);
    if (level !== "error") return;
    this.#refused += 1;
    this.#write();
    this.#stop();
  }

  #write() {
    const refused = this.#refused ? `, ${this.#refused} refused` : "";
    this.footer.textContent = `${this.#count - this.#refused} sent${refused}`;
  }
}
