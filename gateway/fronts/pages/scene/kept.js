// SPDX-License-Identifier: Apache-2.0
// A scene as texts without spaces, which the address of the page keeps.

/**
 * The part of a scene that the address keeps.
 * @typedef {{frame: string, isTop: boolean, follows: boolean, layers: import("./layers.js").Kept[]}} Kept
 */

/** @param {Kept} scene */
export function write({ frame, isTop, follows, layers }) {
  const lines = layers.map(({ isOn, topic, look: { colour, size, mode, points, voxel } }) => [isOn ? "on" : "off", topic, colour, size, mode, ...(points ? [points, voxel] : [])].join(","));
  return [...(frame ? [`frame,${frame}`] : []), ...(isTop ? ["top"] : []), ...(follows ? ["follow"] : []), ...lines];
}

/**
 * @param {string[]} texts
 * @returns {Kept}
 */
export function read(texts) {
  const parts = texts.map((each) => each.split(","));
  const of = (key) => parts.find(([first]) => first === key);
  return {
    frame: of("frame")?.[1] ?? "", isTop: Boolean(of("top")), follows: Boolean(of("follow")),
    layers: parts.filter(([first, topic]) => (first === "on" || first === "off") && topic).map(([first, topic, colour = "", size = "", mode = "", points = "", voxel = ""]) => ({
      isOn: first === "on", topic,
      look: /** @type {any} */ ({ ...(/^#[0-9a-f]{6}$/.test(colour) && { colour }), ...(Number(size) > 0 && { size: Number(size) }), ...(mode && { mode }), ...(Number(points) && { points: Number(points) }), ...(Number(voxel) && { voxel: Number(voxel) }) }),
    })),
  };
}
