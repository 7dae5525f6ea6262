// SPDX-License-Identifier: Apache-2.0
// Colours of a depth image, which comes grey: the nearest white, what is not measured black. A filter of SVG colours it without reading a pixel.

const SHAPE = "http://www.w3.org/2000/svg";
/** From far to near: colour scales of Google (turbo) and matplotlib (viridis), at equal steps. Black is what is not measured. */
const SCALES = {
  turbo: ["30123b", "466be3", "28bbec", "31f299", "a2fc3c", "edd03a", "fb8022", "d23105", "7a0403"],
  viridis: ["440154", "472d7b", "3b528b", "2c728e", "21918c", "28ae80", "5ec962", "addc30", "fde725"],
};

/** The names of the scales. The first is as it comes. */
export const COLOURS = ["gray", ...Object.keys(SCALES)];

/** Return the CSS filter of a scale, which is "" for gray. */
export function colourFilter(name) {
  if (!SCALES[name]) return "";
  const id = `depth-${name}`;
  if (!document.getElementById(id)) document.body.append(filterOf(id, SCALES[name]));
  return `url(#${id})`;
}

function filterOf(id, scale) {
  const channels = ["R", "G", "B"].map((channel, at) => {
    const values = scale.map((colour) => (Number.parseInt(colour.slice(2 * at, 2 * at + 2), 16) / 255).toFixed(3));
    return made(`feFunc${channel}`, { type: "table", tableValues: ["0", ...values].join(" ") });
  });
  const filter = made("filter", { id, "color-interpolation-filters": "sRGB" }, made("feComponentTransfer", {}, ...channels));
  return made("svg", { class: "apart", width: "0", height: "0", "aria-hidden": "true" }, filter);
}

function made(name, attributes, ...children) {
  const element = document.createElementNS(SHAPE, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}
