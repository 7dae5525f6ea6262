// SPDX-License-Identifier: Apache-2.0
// Walls and obstacles of a map as blocks on the floor. A laser sees one height only, so nobody knows how high they are.

import { BufferAttribute, BufferGeometry, Mesh } from "../vendor/three.js";

/** How high the blocks are, in metres: a person sees over them, and robots stand behind them. */
export const HIGH_M = 0.4;
const MOST_BLOCKS = 20_000; // 9 MB on the GPU. Of more, the rest lies flat
const CORNERS = [[0, 0], [1, 0], [1, 1], [0, 1]];

/** Blocks where a map is occupied, in metres from its lower left corner. */
export class Raised {
  mesh;
  /** How many blocks there are. */
  count = 0;

  /** @param {any} material */
  constructor(material) {
    // its corners have no normals, and the hits of a laser lie within walls
    this.mesh = new Mesh(new BufferGeometry(), Object.assign(material, { flatShading: true, transparent: true, opacity: 0.6 }));
  }

  /**
   * Take the cells of a map.
   * @param {Int8Array} values row by row, from the corner on
   * @param {number} columns
   * @param {number} metres how wide a cell is
   * @param {number} least the value from which on a cell is occupied
   */
  build(values, columns, metres, least) {
    const blocks = blocksOf(values, columns, least, MOST_BLOCKS);
    this.count = blocks.length;
    const places = new Float32Array(blocks.length * 8 * 3);
    const indices = new Uint32Array(blocks.length * 30);
    blocks.forEach((block, at) => fill(places, indices, at, block, metres));
    this.mesh.geometry.dispose();
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(places, 3));
    geometry.setIndex(new BufferAttribute(indices, 1));
    this.mesh.geometry = geometry;
  }
}

/**
 * Return the rectangles of occupied cells: each run of a row, together with those of the same columns in the rows above it.
 * @param {Int8Array} values
 * @param {number} columns
 * @param {number} least the value from which on a cell is occupied
 * @param {number} most so many at most: the first ones
 * @returns {number[][]} first column, first row, column and row behind the last
 */
export function blocksOf(values, columns, least, most) {
  const blocks = [];
  let open = new Map(); // first column -> the block that a run of the row before has
  for (let row = 0; row * columns < values.length && blocks.length < most; row += 1) {
    const next = new Map();
    for (const [from, to] of runsOf(values, row * columns, columns, least)) {
      const above = open.get(from);
      const block = above?.[2] === to ? above : [from, row, to, row];
      if (block !== above) blocks.push(block);
      block[3] = row + 1;
      next.set(from, block);
    }
    open = next;
  }
  return blocks.slice(0, most);
}

function runsOf(values, at, columns, least) {
  const runs = [];
  for (let column = 0; column < columns; column += 1) {
    if (values[at + column] < least) continue;
    const from = column;
    while (column < columns && values[at + column] >= least) column += 1;
    runs.push([from, column]);
  }
  return runs;
}

/**
 * Write the corners of a block, and the triangles of its top and its four sides.
 * @param {Float32Array} places
 * @param {Uint32Array} indices
 * @param {number} at
 * @param {number[]} block
 * @param {number} metres
 */
function fill(places, indices, at, [left, low, right, high], metres) {
  CORNERS.forEach(([x, y], corner) => {
    const place = [(x ? right : left) * metres, (y ? high : low) * metres];
    places.set([...place, 0, ...place, HIGH_M], (at * 8 + corner * 2) * 3);
  });
  const triangles = [1, 3, 5, 1, 5, 7];
  for (let side = 0; side < 4; side += 1) {
    const [from, to] = [2 * side, (2 * side + 2) % 8];
    triangles.push(from, to, to + 1, from, to + 1, from + 1);
  }
  indices.set(triangles.map((each) => at * 8 + each), at * 30);
}

/**
 * Return whether a straight way over cells touches an occupied one.
 * @param {(column: number, row: number) => boolean} isOccupied
 * @param {{x: number, y: number}} from in cells
 * @param {{x: number, y: number}} to
 */
export function meets(isOccupied, from, to) {
  const steps = Math.ceil(2 * Math.max(Math.abs(to.x - from.x), Math.abs(to.y - from.y))); // two a cell
  for (let step = 0; step <= steps; step += 1) {
    const share = steps ? step / steps : 0;
    if (isOccupied(Math.floor(from.x + (to.x - from.x) * share), Math.floor(from.y + (to.y - from.y) * share))) return true;
  }
  return false;
}
