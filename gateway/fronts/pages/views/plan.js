// SPDX-License-Identifier: Apache-2.0
// A canvas that shows the world from above. Metres and radians as REP 103 has them: x is right, y is up.

import { element, token } from "../shared/dom.js";
import { say } from "../shared/language.js";

const SIZE = 480; // pixels
const MARGIN = 12;
const ROBOT = 0.12; // metres from its middle to its nose
const LEAST_ROBOT = 7; // pixels
const ARROW = 36; // pixels
const FARTHEST = 1e9; // metres: much farther, and the next number that a computer has is the next line of a grid

/** Return the heading of an orientation, seen from above. */
export function yawOf({ x = 0, y = 0, z = 0, w = 1 }) {
  return Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z));
}

/** Throw an error with words unless a place can be drawn, or a distance. */
export function insist(...metres) {
  if (!metres.every(Number.isFinite)) throw new RangeError(say("plan.number"));
  if (metres.some((each) => Math.abs(each) > FARTHEST)) throw new RangeError(say("plan.far"));
}

/** A picture from above. `begin` says which part of the world it shows. */
export class Plan {
  #pen;
  #scale = 1; // pixels per metre
  #middle = { x: 0, y: 0, up: 0 };

  /** @param {string} label for users who cannot see it */
  constructor(label) {
    this.element = element("canvas", { className: "picture", width: SIZE, height: SIZE, role: "img", aria: { label } });
    this.#pen = this.element.getContext("2d");
  }

  /**
   * Clear it, for what lies around a place.
   * @param {{x: number, y: number}} middle
   * @param {number} reach metres from there to the edge
   * @param {number} up the heading that points up. By default that of y
   */
  begin({ x, y }, reach, up = Math.PI / 2) {
    insist(x, y, reach);
    this.#pen.setTransform(1, 0, 0, 1, 0, 0);
    this.#pen.clearRect(0, 0, SIZE, SIZE);
    this.#middle = { x, y, up };
    this.#scale = (SIZE / 2 - MARGIN) / reach;
  }

  /** Draw circles around a place, each with its distance. */
  rings({ x, y }, farthest) {
    const [middleX, middleY] = this.#at(x, y);
    const step = stepOf(farthest);
    this.#pen.strokeStyle = token("line");
    for (const metres of marks(step, farthest, step)) {
      this.#pen.beginPath();
      this.#pen.arc(middleX, middleY, metres * this.#scale, 0, 2 * Math.PI);
      this.#pen.stroke();
      this.#label(`${rounded(metres)} m`, middleX + 3, middleY - metres * this.#scale - 3);
    }
  }

  /** Draw lines along x and y through what is shown. */
  grid() {
    const reach = SIZE / 2 / this.#scale;
    const step = stepOf(reach);
    const columns = marks(this.#middle.x - reach, this.#middle.x + reach, step).map((x) => ({ x, left: this.#at(x, 0)[0] }));
    const rows = marks(this.#middle.y - reach, this.#middle.y + reach, step).map((y) => ({ y, top: this.#at(0, y)[1] }));
    this.#pen.strokeStyle = token("line");
    this.#pen.beginPath();
    for (const { left } of columns) {
      this.#pen.moveTo(left, 0);
      this.#pen.lineTo(left, SIZE);
    }
    for (const { top } of rows) {
      this.#pen.moveTo(0, top);
      this.#pen.lineTo(SIZE, top);
    }
    this.#pen.stroke();
    for (const { x, left } of columns) this.#label(`${rounded(x)}`, left + 3, SIZE - 4);
    for (const { y, top } of rows) this.#label(`${rounded(y)} m`, 3, top - 3);
  }

  /** Draw what an offscreen canvas has, a pixel of it as wide as *resolution* metres, its lower left corner at *origin*. */
  image(canvas, origin, resolution) {
    const [left, bottom] = this.#at(origin.x, origin.y);
    this.#pen.save();
    this.#pen.imageSmoothingEnabled = resolution * this.#scale < 1; // or a thin wall would vanish between two pixels
    this.#pen.translate(left, bottom);
    this.#pen.rotate(-origin.yaw);
    this.#pen.scale(resolution * this.#scale, resolution * this.#scale);
    this.#pen.drawImage(canvas, 0, -canvas.height);
    this.#pen.restore();
  }

  /** Draw the hits of a laser scan that was taken at a pose. */
  scan({ ranges, angle_min: first, angle_increment: step, range_min: least, range_max: most }, { x, y, yaw }, colour = "scan") {
    this.#pen.fillStyle = token(colour);
    ranges.forEach((range, index) => {
      if (!isHit(range, least, most)) return;
      const heading = yaw + first + index * step;
      const [left, top] = this.#at(x + Math.cos(heading) * range, y + Math.sin(heading) * range);
      this.#pen.fillRect(left - 1.5, top - 1.5, 3, 3);
    });
  }

  /** Draw a line through places. */
  line(places, colour = "accent") {
    this.#pen.strokeStyle = token(colour);
    this.#pen.lineWidth = 2;
    this.#pen.beginPath();
    for (const { x, y } of places) this.#pen.lineTo(...this.#at(x, y));
    this.#pen.stroke();
    this.#pen.lineWidth = 1;
  }

  /** Draw a point, and a circle around it, which may have no size. */
  circle({ x, y }, radius, colour = "warning") {
    const [left, top] = this.#at(x, y);
    this.#pen.strokeStyle = this.#pen.fillStyle = token(colour);
    this.#pen.beginPath();
    this.#pen.arc(left, top, 4, 0, 2 * Math.PI);
    this.#pen.fill();
    this.#pen.beginPath();
    this.#pen.arc(left, top, radius * this.#scale, 0, 2 * Math.PI);
    this.#pen.stroke();
  }

  /** Draw the robot, its nose forward. */
  robot({ x, y, yaw }, colour = "warning") {
    const length = Math.max(LEAST_ROBOT, ROBOT * this.#scale);
    const [left, top] = this.#at(x, y);
    const turned = yaw - this.#middle.up + Math.PI / 2;
    this.#pen.fillStyle = token(colour);
    this.#pen.beginPath();
    for (const [share, angle] of [[1, 0], [0.9, 2.5], [0.9, -2.5]]) {
      this.#pen.lineTo(left + Math.cos(turned + angle) * share * length, top - Math.sin(turned + angle) * share * length);
    }
    this.#pen.fill();
  }

  /** Draw an arrow that begins at a place. */
  arrow({ x, y, yaw }, colour) {
    const [left, top] = this.#at(x, y);
    const turned = yaw - this.#middle.up + Math.PI / 2;
    const end = (length, angle) => [left + Math.cos(turned + angle) * length, top - Math.sin(turned + angle) * length];
    this.#pen.strokeStyle = token(colour);
    this.#pen.lineWidth = 3;
    this.#pen.beginPath();
    this.#pen.arc(left, top, 5, 0, 2 * Math.PI);
    for (const [from, to] of [[[5, 0], [ARROW, 0]], [[ARROW * 0.75, 0.25], [ARROW, 0]], [[ARROW * 0.75, -0.25], [ARROW, 0]]]) {
      this.#pen.moveTo(...end(...from));
      this.#pen.lineTo(...end(...to));
    }
    this.#pen.stroke();
    this.#pen.lineWidth = 1;
  }

  /** The place in the middle. */
  get middle() {
    return this.#middle;
  }

  /** Return the place that a pointer is at. */
  placeOf({ clientX, clientY }) {
    const { left, top, width, height } = this.element.getBoundingClientRect();
    const metres = SIZE / Math.min(width, height) / this.#scale; // of a pixel of the screen: the picture is square in whatever box
    const [right, up] = [(clientX - left - width / 2) * metres, (top + height / 2 - clientY) * metres];
    const turn = Math.PI / 2 - this.#middle.up;
    return {
      x: this.#middle.x + Math.cos(turn) * right + Math.sin(turn) * up,
      y: this.#middle.y - Math.sin(turn) * right + Math.cos(turn) * up,
    };
  }

  #label(text, left, bottom) {
    this.#pen.save();
    this.#pen.font = "12px system-ui";
    this.#pen.lineJoin = "round";
    this.#pen.lineWidth = 4;
    this.#pen.strokeStyle = token("surface"); // it can be read on any ground
    this.#pen.strokeText(text, left, bottom);
    this.#pen.fillStyle = token("quiet");
    this.#pen.fillText(text, left, bottom);
    this.#pen.restore();
  }

  #at(x, y) {
    const turn = Math.PI / 2 - this.#middle.up;
    const [right, ahead] = [x - this.#middle.x, y - this.#middle.y];
    return [
      SIZE / 2 + (Math.cos(turn) * right - Math.sin(turn) * ahead) * this.#scale,
      SIZE / 2 - (Math.sin(turn) * right + Math.cos(turn) * ahead) * this.#scale,
    ];
  }
}

/** Return the distance between lines: 1, 2 or 5 of a power of ten, three to seven of them. */
function stepOf(metres) {
  const power = 10 ** Math.floor(Math.log10(metres / 3));
  return power * ([5, 2, 1].find((each) => each * power <= metres / 3) ?? 1);
}

/** Return the multiples of a step between two numbers. */
function marks(least, most, step) {
  const first = Math.ceil(least / step);
  return Array.from({ length: Math.max(0, Math.floor(most / step) - first + 1) }, (_, index) => (first + index) * step);
}

/** Return whether a ray of a laser has hit something. One that has not may be infinite, as may what its laser reaches. */
export const isHit = (range, least, most) => Number.isFinite(range) && range >= least && range <= most;

const rounded = (metres) => Number(metres.toPrecision(3));
