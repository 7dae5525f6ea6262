// SPDX-License-Identifier: Apache-2.0
// The limits of a robot's joints, from its URDF.

const MOST_CHARACTERS = 10_000_000; // of a URDF: its meshes are not in it

/**
 * @typedef {{type: string, lower: number, upper: number, velocity: number, effort: number}} Limit
 * `lower` and `upper` are in radians, or in metres of a prismatic joint. NaN: it says none
 */

/**
 * Return the limits of the joints by their names. A text that is not a URDF has no joints.
 * @param {string} urdf
 * @returns {Map<string, Limit>}
 */
export function limitsOf(urdf) {
  if (urdf.length > MOST_CHARACTERS) return new Map();
  const joints = new DOMParser().parseFromString(urdf, "application/xml").querySelectorAll("robot > joint");
  return new Map([...joints].map((joint) => [joint.getAttribute("name"), limitOf(joint)]));
}

function limitOf(joint) {
  const limit = joint.querySelector("limit");
  const of = (name) => Number.parseFloat(limit?.getAttribute(name));
  const type = joint.getAttribute("type");
  const isEndless = type === "continuous";
  const [lower, upper] = isEndless ? [-Math.PI, Math.PI] : [of("lower"), of("upper")];
  return { type, lower, upper, velocity: of("velocity"), effort: of("effort") };
}
