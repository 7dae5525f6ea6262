// SPDX-License-Identifier: Apache-2.0
import { element } from "../shared/dom.js";

/** Pictures: the newest one, decoded beside the page's own thread. */
export class ImageView {
  options = { compression: "cbor", image: { quality: 70, max_width: 640, adapt: true } };
  #canvas = element("canvas", { className: "picture", width: 320, height: 240, role: "img" });
  #isDecoding = false;
  #next = null;
  #failure = ""; // what is said of the newest picture

  constructor(card) {
    this.card = card;
    this.element = this.#canvas;
    this.#canvas.setAttribute("aria-label", `picture of ${card.topic}`);
  }

  show(message) {
    this.#next = message;
    if (!this.#isDecoding) this.#decode();
  }

  async #decode() {
    this.#isDecoding = true;
    while (this.#next) {
      const { data, format } = this.#next;
      this.#next = null;
      try {
        const type = format.includes("png") ? "image/png" : "image/jpeg";
        const bitmap = await createImageBitmap(new Blob([data], { type }));
        if (this.#canvas.width !== bitmap.width) this.#canvas.width = bitmap.width; // to set it anew lays the page out anew
        if (this.#canvas.height !== bitmap.height) this.#canvas.height = bitmap.height;
        this.#canvas.getContext("bitmaprenderer").transferFromImageBitmap(bitmap); // closes it, and copies nothing
        if (this.#failure) this.card.untell(this.#failure);
        this.#failure = "";
      } catch (error) {
        this.#failure = `this picture (${format}) cannot be shown: ${error.message}`;
        this.card.tell(this.#failure);
      }
    }
    this.#isDecoding = false;
  }
}
