// SPDX-License-Identifier: Apache-2.0
// A worker that paints a nav_msgs/msg/OccupancyGrid. If a pixel has several cells, it shows the most occupied one, or a thin wall would vanish.

import { insistOnCells, patch, scaleOf } from "./occupancy.js";

const MOST_PIXELS = 1024 * 1024; // twice as wide and high as a plan
const STRIPE = 1024 * 1024; // cells that are read at once, 4 MB of a picture
// Of each octet of a cell how much it matters: 1 to 101 from free to occupied, 0 for others, which are unknown.
const RANKS = Uint8Array.from({ length: 256 }, (_, value) => (value <= 100 ? value + 1 : 0));

let kept = null; // the map, with an octet for each cell: parts of it may change

self.onmessage = async ({ data: { map, patches, colours } }) => {
  try {
    if (map) kept = null;
    if (map) kept = { width: map.width, height: map.height, octets: await octetsOf(map) };
    if (!kept) throw new RangeError("none", { cause: {} });
    for (const each of patches) patch(kept.octets, kept.width, each);
    const painted = paint(kept, colours);
    self.postMessage(painted, { transfer: [painted.bitmap, painted.values.buffer] });
  } catch (error) {
    self.postMessage({ problem: error.message, cause: error.cause });
  }
};

function paint({ width, height, octets }, colours) {
  const cells = scaleOf(width, height, MOST_PIXELS);
  const [columns, rows] = [Math.ceil(width / cells), Math.ceil(height / cells)];
  const ranks = new Uint8Array(columns * rows);
  for (let row = 0; row < height; row += 1) {
    const to = Math.floor(row / cells) * columns;
    rank(ranks.subarray(to, to + columns), octets, row * width, cells, width);
  }
  return { bitmap: picture(ranks, columns, rows, colours), cells, values: Int8Array.from(ranks, (each) => each - 1) };
}

/** Raise the ranks of a row of pixels to those of a row of cells, which begins at a place in *octets*. */
function rank(pixels, octets, at, cells, width) {
  for (let column = 0, cell = 0; column < pixels.length; column += 1) {
    let highest = pixels[column];
    for (const end = Math.min(cell + cells, width); cell < end; cell += 1) {
      highest = Math.max(highest, RANKS[octets[at]]);
      at += 1;
    }
    pixels[column] = highest;
  }
}

async function octetsOf({ width, height, data, format }) {
  if (format) return octetsOfPicture(data, width, height);
  insistOnCells(width, height, data.length);
  return Uint8Array.from(data);
}

/** Return the octets of a grey picture. Its colours are four times as large, so they are read in stripes. */
async function octetsOfPicture(data, width, height) {
  const bitmap = await createImageBitmap(new Blob([data]), { colorSpaceConversion: "none" });
  insistOnCells(width, height, bitmap.width * bitmap.height);
  const octets = new Uint8Array(width * height);
  const most = Math.max(1, Math.floor(STRIPE / width));
  const pen = new OffscreenCanvas(width, Math.min(height, most)).getContext("2d", { willReadFrequently: true });
  for (let first = 0; first < height; first += most) {
    pen.drawImage(bitmap, 0, -first);
    const colours = pen.getImageData(0, 0, width, Math.min(most, height - first)).data;
    for (let at = first * width, from = 0; from < colours.length; from += 4, at += 1) octets[at] = colours[from];
  }
  bitmap.close();
  return octets;
}

/** Return an image of ranks, its first row at the bottom. */
function picture(ranks, columns, rows, colours) {
  const pixels = new Uint32Array(columns * rows);
  for (let row = 0; row < rows; row += 1) {
    const to = (rows - 1 - row) * columns;
    for (let column = 0; column < columns; column += 1) pixels[to + column] = colours[(ranks[row * columns + column] - 1) & 255];
  }
  const canvas = new OffscreenCanvas(columns, rows);
  canvas.getContext("2d").putImageData(new ImageData(new Uint8ClampedArray(pixels.buffer), columns), 0, 0);
  return canvas.transferToImageBitmap();
}
