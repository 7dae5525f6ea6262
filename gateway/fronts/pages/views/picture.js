// SPDX-License-Identifier: Apache-2.0
import { element } from "../shared/dom.js";
import { say } from "../shared/language.js";
import { Newest } from "./newest.js";

/** The newest image, decoded on another thread. */
export class Picture {
  options = { compression: "cbor", image: { quality: 70, max_width: 640, adapt: true } };
  // as most cameras have it: then nothing below moves with the first one
  #canvas = element("canvas", { className: "picture", width: 640, height: 480, role: "img" });
  #newest;

  /**
   * @param {{topic: string, tell: (words: string) => void, untell: (words: string) => void}} card
   * @param {(message: any) => void} [shown] is called after an image is shown, with its message
   */
  constructor(card, shown = () => {}) {
    this.element = this.#canvas;
    this.#canvas.setAttribute("aria-label", say("image.label", { topic: card.topic }));
    this.#newest = new Newest(card, ({ format }, why) => say("image.unshown", { format, why }), async (message) => {
      await this.#decode(message);
      shown(message);
    });
  }

  show(message) {
    this.#newest.take(message);
  }

  async #decode({ data, format }) {
    const type = format.includes("png") ? "image/png" : "image/jpeg";
    const bitmap = await createImageBitmap(new Blob([data], { type }));
    if (this.#canvas.width !== bitmap.width) this.#canvas.width = bitmap.width; // setting it causes a new layout of the page
    if (this.#canvas.height !== bitmap.height) this.#canvas.height = bitmap.height;
    this.#canvas.getContext("bitmaprenderer").transferFromImageBitmap(bitmap); // closes it, and copies nothing
  }
}
