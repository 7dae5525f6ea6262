// SPDX-License-Identifier: Apache-2.0
// A worker that paints a nav_msgs/msg/OccupancyGrid. If a pixel has several cells, it shows the most occupied one, or a thin wall would vanish.

import { insistOnCells, scaleOf } from "./occupancy.js";

const MOST_PIXELS = 1024 * 1024; // twice as wide and high as a plan
const STRIPE = 1024 * 1024; // cells that are read at once, 4 MB of a picture
// Of each octet of a cell how much it matters: 1 to 101 from free to occupied, 0 for others, which are unknown.
const RANKS = Uint8Array.from({ length: 256 }, (_, value) => (value <= 100 ? value + 1 : 0));

self.onmessage = async ({ data: map }) => {
  try {
    const painted = await paint(map);
    self.postMessage(painted, { transfer: [painted.bitmap, painted.values.buffer] });
  } catch (error) {
    self.postMessage({ problem: error.message });
  }
};

async function paint({ width, height, data, format, colours }) {
  const read = format ? await reader(data, width, height) : plainReader(data, width, height);
  const cells = scaleOf(width, height, MOST_PIXELS);
  const [columns, rows] = [Math.ceil(width / cells), Math.ceil(height / cells)];
  const ranks = new Uint8Array(columns * rows);
  const most = Math.max(1, Math.floor(STRIPE / width));
  for (let first = 0; first < height; first += most) {
    const count = Math.min(most, height - first);
    const { values, step } = read(first, count);
    for (let row = 0; row < count; row += 1) {
      const to = Math.floor((first + row) / cells) * columns;
      rank(ranks.subarray(to, to + columns), values, row * width * step, step, cells, width);
    }
  }
  return { bitmap: picture(ranks, columns, rows, colours), cells, values: Int8Array.from(ranks, (each) => each - 1) };
}

/** Raise the ranks of a row of pixels to those of a row of cells, which begins at a place in *values*. */
function rank(pixels, values, at, step, cells, width) {
  for (let column = 0, cell = 0; column < pixels.length; column += 1) {
    let highest = pixels[column];
    for (const end = Math.min(cell + cells, width); cell < end; cell += 1) {
      highest = Math.max(highest, RANKS[values[at] & 255]);
      at += step;
    }
    pixels[column] = highest;
  }
}

function plainReader(data, width, height) {
  insistOnCells(width, height, data.length);
  return (first, count) => ({ values: data.slice(first * width, (first + count) * width), step: 1 });
}

/** Return a function that reads rows of a grey picture, as colours. */
async function reader(data, width, height) {
  const bitmap = await createImageBitmap(new Blob([data]), { colorSpaceConversion: "none" });
  insistOnCells(width, height, bitmap.width * bitmap.height);
  const pen = new OffscreenCanvas(width, Math.min(height, Math.max(1, Math.floor(STRIPE / width)))).getContext("2d", { willReadFrequently: true });
  return (first, count) => {
    pen.drawImage(bitmap, 0, -first);
    return { values: pen.getImageData(0, 0, width, count).data, step: 4 };
  };
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
