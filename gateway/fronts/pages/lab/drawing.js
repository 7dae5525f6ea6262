// SPDX-License-Identifier: Apache-2.0
// Whether the room is drawn: a browser takes WebGL away from a page, and may give it back. three.js then draws as before.

import { say } from "../shared/language.js";
import { element } from "../shared/dom.js";

const WORDS = say("lab.undrawn");

/** Says in the view that the room is not drawn. */
export class Drawing {
  #words = element("p", { className: "lost", role: "alert", hidden: true }, WORDS);

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {() => void} lost is called when nothing is drawn any more
   */
  constructor(canvas, lost) {
    canvas.after(this.#words);
    canvas.addEventListener("webglcontextlost", () => {
      this.#words.hidden = false;
      lost();
    });
    canvas.addEventListener("webglcontextrestored", () => (this.#words.hidden = true));
  }

  /** Why nobody can point at anything, or "". */
  get refusal() {
    return this.#words.hidden ? "" : WORDS;
  }
}
