// SPDX-License-Identifier: Apache-2.0
import { COMMAND_TYPES } from "../../shared/command_topic.js";
import { element } from "../../shared/dom.js";
import { say } from "../../shared/language.js";
import { isHeld } from "../../shared/stop_held.js";
import { Form } from "../forms/form.js";
import { FormCard, NOT_CONNECTED } from "./form_card.js";

const RATES_HZ = [1, 2, 5, 10, 20];

/** A form that publishes to a topic: once, or again and again until it is told to stop, by STOP too, or nobody looks. */
export class PublishCard extends FormCard {
  #listener;
  #timer = 0;
  #count = 0;
  #refused = 0; // of these, by the gateway
  #rates = element("select", { title: say("publish.rate") });
  #repeat = element("button", { type: "button", aria: { pressed: "false" } }, say("publish.repeat"));
  #forgets = [];
  #isCommand = false; // whether the gateway guards what moves a robot by it

  constructor(gateway, shown, actions) {
    super(gateway, shown, actions, { kind: "publish", typeOf: () => gateway.graph.typeOf(shown.topic) });
    this.#listener = gateway.listen((frame) => this.#heard(frame));
    this.#repeat.setAttribute("aria-label", `${say("publish.repeat")} ${shown.topic}`);
    this.#rates.setAttribute("aria-label", say("topic.rate.of", { topic: shown.topic }));
    for (const hz of RATES_HZ) this.#rates.append(new Option(`${hz} Hz`, String(hz)));
    this.#repeat.onclick = () => (this.#timer ? this.#stop() : this.#start());
    this.#rates.onchange = () => this.#timer && this.#goOn();
    this.buttons.append(this.#repeat, this.#rates);
    // a message sent into a silent connection would arrive when nobody expects it
    this.#forgets = [
      gateway.on("state", () => this.#end(say("end.connection"))),
      gateway.on("silence", () => this.#end(say("end.silence"))),
      gateway.on("stopping", () => this.#end(say("end.stop"))),
    ];
    this.body.addEventListener("input", () => this.#end(say("end.message"))); // half a number is not a number
  }

  formOf(described) {
    return new Form(described.schema);
  }

  replaced() {
    this.#stop(); // nobody has seen the message that would go on
  }

  submit() {
    if (isHeld()) throw new Error(say("stop.held"));
    this.tell("");
    const { topic, type } = this;
    const isSent = this.gateway.send({ op: "publish", id: this.#listener.id, topic, type }, { msg: this.form.json() });
    if (!isSent) throw new Error(NOT_CONNECTED);
    this.#count += 1;
    this.#write();
  }

  rest() {
    super.rest();
    this.#end(document.hidden ? say("end.hidden") : say("end.tab"));
  }

  close() {
    this.#stop();
    this.#listener.end();
    for (const forget of this.#forgets) forget();
    super.close();
  }

  #start() {
    this.#stop();
    if (!this.act()) return;
    this.#learnWhatItMoves();
    this.#goOn();
    this.#repeat.setAttribute("aria-pressed", true);
  }

  /** Repeat from now on, at the rate that is chosen. */
  #goOn() {
    clearInterval(this.#timer);
    this.#timer = setInterval(() => this.act() || this.#stop(), 1000 / this.#rates.value);
  }

  #stop() {
    if (this.#timer && this.#isCommand) this.gateway.send({ op: "publish", id: this.#listener.id, topic: this.topic, type: this.type, msg: {} }); // as a stick does
    clearInterval(this.#timer);
    this.#timer = 0;
    this.#repeat.setAttribute("aria-pressed", false);
  }

  async #learnWhatItMoves() {
    const isGuarded = () => this.gateway.ask({ op: "control", topic: this.topic }).then(() => true, () => false);
    this.#isCommand = COMMAND_TYPES.includes(this.type) && (await isGuarded());
  }

  /** End what is repeated, if anything is, and say why. */
  #end(why) {
    if (!this.#timer) return;
    this.#stop();
    this.tell(say("publish.ended", { why }));
  }

  #heard({ op, msg, level, code }) {
    if (op !== "status") return;
    this.tell(code === "tripped" ? say("publish.tripped") : msg);
    if (level !== "error") return;
    this.#refused += 1;
    this.#write();
    this.#stop();
  }

  #write() {
    const sent = say("publish.sent", { count: this.#count - this.#refused });
    this.footer.textContent = this.#refused ? `${sent}, ${say("refused", { count: this.#refused })}` : sent;
  }
}
