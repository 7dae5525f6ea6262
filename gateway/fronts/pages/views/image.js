// SPDX-License-Identifier: Apache-2.0
import { element } from "../shared/dom.js";
import { say } from "../shared/language.js";
import { colourFilter, COLOURS } from "./depth_colours.js";
import { Picture } from "./picture.js";
import { Zoom } from "./zoom.js";

const FULL_WIDTH = 1920; // pixels, where it fills the page
const USUAL_RANGE_M = [0, 10]; // of a depth image, as the gateway has it

/** The newest image, full screen with zoom. A depth image also has its range, and colours. */
export class ImageView {
  static title = say("view.image");
  static types = ["sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"];

  #card;
  #picture;
  #depth; // the tools for it
  #ends; // near and far
  #colours;
  #stage;
  #zoom;
  #ignore;

  constructor(card) {
    this.#card = card;
    this.#picture = new Picture(card, ({ depth_range_m: range }) => this.#depth.hidden === Boolean(range) && this.#paintDepth(Boolean(range)));
    this.#stage = element("div", { className: "stage", role: "group", aria: { label: say("image.stage", { topic: card.topic }) } }, this.#picture.element);
    this.#zoom = new Zoom(this.#stage, this.#picture.element);
    this.#ends = ["near", "far"].map((name, index) => this.#end(name, USUAL_RANGE_M[index]));
    this.#colours = element("select", { aria: { label: say("colors.of", { topic: card.topic }) } }, ...COLOURS.map((each) => new Option(say(`colors.${each}`), each)));
    this.#colours.value = COLOURS.includes(card.settings.colors) ? card.settings.colors : COLOURS[0];
    this.#colours.onchange = () => {
      card.keep("colors", this.#colours.value, COLOURS[0]);
      this.#paintDepth();
    };
    const [near, far] = this.#ends.map((each, index) => element("label", {}, `${say(`ends.${["near", "far"][index]}`)} (m) `, each));
    this.#depth = element("div", { className: "tools", hidden: true }, near, far, this.#colours);
    const full = element("button", { type: "button", title: say("full.about"), aria: { label: say("full.of", { topic: card.topic }) } }, say("full"));
    full.onclick = () => card.fill();
    this.#ignore = card.onFull((isFull) => this.#fill(isFull, full));
    this.#look(card.isFull, full);
    this.element = element("div", { className: "pictured" }, this.#stage, this.#depth, element("div", { className: "tools" }, full));
  }

  get options() {
    const { compression, image: usual } = this.#picture.options;
    const image = this.#card.isFull ? { ...usual, max_width: FULL_WIDTH } : usual;
    const range = this.#ends.map((each, index) => (each.validity.valid && each.value !== "" ? each.valueAsNumber : USUAL_RANGE_M[index]));
    const isUsual = String(range) === String(USUAL_RANGE_M) || !(range[0] < range[1]);
    return { compression, image: isUsual ? image : { ...image, depth_range_m: range } };
  }

  show(message) {
    this.#picture.show(message);
  }

  close() {
    this.#ignore();
  }

  #paintDepth(isDepth = true) {
    this.#depth.hidden = !isDepth;
    this.#picture.element.style.filter = isDepth ? colourFilter(this.#colours.value) : "";
  }

  /** Return a field for an end of the range of a depth image. */
  #end(name, usual) {
    const made = element("input", { type: "number", min: 0, max: 1000, step: "any", value: this.#card.settings[name] ?? usual, aria: { label: say(`ends.${name}.of`, { topic: this.#card.topic }) } });
    made.onchange = () => {
      this.#card.keep(name, made.value, usual);
      this.#card.subscribe();
    };
    return made;
  }

  #fill(isFull, button) {
    const hadFocus = this.#stage === document.activeElement;
    this.#look(isFull, button);
    this.#card.subscribe(); // as large as it is seen
    if (isFull) this.#stage.focus();
    else if (hadFocus) button.focus();
  }

  #look(isFull, button) {
    button.textContent = isFull ? say("full.leave") : say("full");
    this.#stage.tabIndex = isFull ? 0 : -1;
    this.#zoom.isOn = isFull;
    this.#zoom.reset();
  }
}
