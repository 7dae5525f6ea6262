// SPDX-License-Identifier: Apache-2.0
// The cells of a nav_msgs/msg/OccupancyGrid as pixels.

import { token } from "../shared/dom.js";

/** A value that an update has for a cell which stays as it is. No octet is so large. */
export const UNCHANGED = 1000;
const LONGEST = 4096; // pixels of a side: what any GPU takes, for a map that is long and narrow

/** Throw an error unless a map has as many cells as it says: `map.wrong.` leads to its words, with the values of its cause, because a worker has no language. */
export function insistOnCells(width, height, count) {
  if (!(width > 0 && height > 0)) throw new RangeError("size", { cause: { width, height } });
  if (count !== width * height) throw new RangeError("count", { cause: { width, height, count } });
}

/** Put the values of an update into the cells of a map that is so many wide. */
export function patch(cells, wide, { x, y, width, data }) {
  for (let at = 0; at < data.length; at += 1) {
    if (data[at] !== UNCHANGED) cells[(y + Math.floor(at / width)) * wide + x + (at % width)] = data[at];
  }
}

/** Return how many cells a pixel has to be wide, for a map in at most so many pixels. */
export const scaleOf = (width, height, most) => Math.ceil(Math.max(Math.sqrt((width * height) / most), width / LONGEST, height / LONGEST));

/** Return a colour for each octet of a cell: 0 to 100 from free to occupied. Others, as -1, are unknown. */
export function palette() {
  const [free, occupied] = [octets(token("map-free")), octets(token("map-occupied"))];
  const colours = new Uint32Array(256).fill(packed(octets(token("map-unknown"))));
  for (let value = 0; value <= 100; value += 1) {
    colours[value] = packed(free.map((each, index) => each + ((occupied[index] - each) * value) / 100));
  }
  return colours;
}

const octets = (colour) => [1, 3, 5].map((at) => Number.parseInt(colour.slice(at, at + 2), 16));
/** @param {number[]} colour */
const packed = ([red, green, blue]) => (0xff000000 | (blue << 16) | (green << 8) | red) >>> 0;
