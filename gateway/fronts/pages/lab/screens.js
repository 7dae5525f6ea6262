// SPDX-License-Identifier: Apache-2.0
// Information screens: text on a wall.

import { CanvasTexture, LinearFilter, Mesh, MeshBasicMaterial, PlaneGeometry, SRGBColorSpace } from "../vendor/three.js";
import { token } from "../shared/dom.js";

const WIDE_PX = 768;
const HIGH_PX = 512;
const WIDE_M = 2.4;
const LINE_PX = 30;
const MARGIN_PX = 24;
const COLUMNS = 48; // characters of a line
const LINES = 14; // below the title
const REST_MS = 250; // nobody reads faster, and each drawing is sent to the GPU

/** A screen with a title and some lines. */
export class Screen {
  /** Its content, as text. */
  text = "";
  #canvas = new OffscreenCanvas(WIDE_PX, HIGH_PX);
  #pen = this.#canvas.getContext("2d");
  #texture = new CanvasTexture(this.#canvas);
  mesh = new Mesh(new PlaneGeometry(WIDE_M, (WIDE_M * HIGH_PX) / WIDE_PX), new MeshBasicMaterial({ map: this.#texture }));
  #title;
  #given = "";
  #lines = [];
  #isDirty = true;
  #drawnMs = -Infinity;

  constructor(title) {
    this.#title = title;
    this.#texture.colorSpace = SRGBColorSpace;
    this.#texture.generateMipmaps = false;
    this.#texture.minFilter = LinearFilter;
    this.mesh.userData.screen = this;
  }

  /** Show a title and a text. */
  show(title, text) {
    const given = `${title}\n${text}`;
    if (given === this.#given) return;
    this.#given = given;
    this.#title = title;
    this.#lines = wrapped(text).slice(0, LINES);
    this.dirty();
  }

  /** Add a line below, and let the oldest go. */
  add(line) {
    this.#lines = [...this.#lines, ...wrapped(line)].slice(-LINES);
    this.dirty();
  }

  /** Draw it again when there is time. */
  dirty() {
    this.#isDirty = true;
  }

  /** Draw, if there is something new and the last time is some while ago. Return whether it did. */
  step(now) {
    if (!this.#isDirty || now - this.#drawnMs < REST_MS) return false;
    this.#isDirty = false;
    this.#drawnMs = now;
    this.text = [this.#title, ...this.#lines].join("\n");
    this.#pen.fillStyle = token("surface");
    this.#pen.fillRect(0, 0, WIDE_PX, HIGH_PX);
    this.#pen.strokeStyle = token("accent");
    this.#pen.lineWidth = 6;
    this.#pen.strokeRect(3, 3, WIDE_PX - 6, HIGH_PX - 6);
    this.#pen.textBaseline = "top";
    this.#pen.fillStyle = token("accent");
    this.#pen.font = `bold ${LINE_PX}px system-ui, sans-serif`;
    this.#pen.fillText(this.#title, MARGIN_PX, MARGIN_PX, WIDE_PX - 2 * MARGIN_PX);
    this.#pen.fillStyle = token("text");
    this.#pen.font = `${LINE_PX - 6}px ui-monospace, "DejaVu Sans Mono", monospace`;
    for (let at = 0; at < this.#lines.length; at += 1) {
      this.#pen.fillText(this.#lines[at], MARGIN_PX, MARGIN_PX + LINE_PX * (at + 1.6), WIDE_PX - 2 * MARGIN_PX);
    }
    this.#texture.needsUpdate = true;
    return true;
  }
}

/** Return lines that fit. A longer line continues in the next one. */
function wrapped(text) {
  const lines = [];
  for (const line of text.slice(0, 2 * COLUMNS * LINES).split("\n")) {
    for (let at = 0; at === 0 || at < line.length; at += COLUMNS) lines.push(line.slice(at, at + COLUMNS));
  }
  return lines;
}
