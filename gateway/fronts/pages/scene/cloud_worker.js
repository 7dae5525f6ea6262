// SPDX-License-Identifier: Apache-2.0
// A worker that reads thinned clouds, and gives each point a colour.

const NOT_A_NUMBER = -32768;
const LARGEST = 32767;
// from low to high: blue, cyan, green, yellow, red
const STOPS = [[0.2, 0.3, 0.95], [0.1, 0.8, 0.9], [0.3, 0.9, 0.3], [0.95, 0.85, 0.2], [0.95, 0.25, 0.2]];
const RAMP = Uint8Array.from({ length: 3 * 256 }, (_, at) => {
  const [place, channel] = [(Math.floor(at / 3) / 255) * (STOPS.length - 1), at % 3];
  const low = Math.min(Math.floor(place), STOPS.length - 2);
  return 255 * (STOPS[low][channel] + (STOPS[low + 1][channel] - STOPS[low][channel]) * (place - low));
});

self.onmessage = ({ data: { buffer, points, fields, mode, colour } }) => {
  const places = new Int16Array(buffer, 0, 3 * points);
  const colours = new Uint8Array(3 * points);
  const at = fields.findIndex(({ name }) => name === mode);
  if (at < 3) {
    if (mode === "height") ramp(colours, points, (index) => places[3 * index + 2]);
    else flat(colours, colour);
  } else if (fields[at].format === "rgb565") {
    real(colours, new Uint16Array(buffer, 2 * at * points, points));
  } else {
    const values = new Int16Array(buffer, 2 * at * points, points);
    ramp(colours, points, (index) => values[index]);
  }
  const [scale, offset] = ["scale", "offset"].map((key) => fields.slice(0, 3).map((each) => each[key]));
  self.postMessage({ places, colours, scale, offset }, { transfer: [places.buffer, colours.buffer] });
};

function ramp(colours, points, valueOf) {
  for (let index = 0; index < points; index += 1) {
    const value = valueOf(index);
    const from = value === NOT_A_NUMBER ? 0 : 3 * Math.round(((value + LARGEST) / (2 * LARGEST)) * 255);
    colours[3 * index] = RAMP[from];
    colours[3 * index + 1] = RAMP[from + 1];
    colours[3 * index + 2] = RAMP[from + 2];
  }
}

function flat(colours, colour) {
  const octets = [1, 3, 5].map((at) => Number.parseInt(colour.slice(at, at + 2), 16));
  for (let at = 0; at < colours.length; at += 1) colours[at] = octets[at % 3];
}

function real(colours, packed) {
  packed.forEach((each, index) => {
    colours[3 * index] = ((each >> 11) * 255) / 31;
    colours[3 * index + 1] = (((each >> 5) & 63) * 255) / 63;
    colours[3 * index + 2] = ((each & 31) * 255) / 31;
  });
}
