// SPDX-License-Identifier: Apache-2.0
import { CanvasTexture, LinearFilter, Sprite, SpriteMaterial } from "../vendor/three.js";

const HIGH = 48; // pixels
const LONGEST = 2048;

/** Return a text that always faces the viewer, so many metres high. */
export function label(text, height, colour = "#ffffff") {
  const canvas = document.createElement("canvas");
  const pen = canvas.getContext("2d");
  const font = `${HIGH * 0.7}px system-ui`;
  pen.font = font;
  const lines = text.split("\n").slice(0, 20);
  canvas.width = Math.min(LONGEST, Math.ceil(Math.max(...lines.map((line) => pen.measureText(line).width))) + 12);
  canvas.height = HIGH * lines.length;
  Object.assign(pen, { font, fillStyle: colour, strokeStyle: "rgb(0 0 0 / 80%)", lineWidth: 5, lineJoin: "round", textBaseline: "middle" });
  lines.forEach((line, at) => {
    pen.strokeText(line, 6, HIGH * (at + 0.5)); // it can be read on any ground
    pen.fillText(line, 6, HIGH * (at + 0.5));
  });
  const map = new CanvasTexture(canvas);
  Object.assign(map, { minFilter: LinearFilter, generateMipmaps: false });
  const sprite = new Sprite(new SpriteMaterial({ map, depthTest: false }));
  sprite.scale.set((height * canvas.width) / HIGH, height * lines.length, 1);
  return sprite;
}
