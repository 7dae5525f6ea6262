// SPDX-License-Identifier: Apache-2.0
// A robot description (URDF) as data.

import { say } from "../shared/language.js";

/** @typedef {{kind: string, size: number[], uri: string, xyz: number[], rpy: number[], colour: number[]|null}} Visual */
/** @typedef {{name: string, type: string, parent: string, child: string, xyz: number[], rpy: number[], axis: number[], mimic: {joint: string, multiplier: number, offset: number}|null}} Joint */

/**
 * Read a URDF. Throws with words if it is not one.
 * @param {string} text
 * @returns {{name: string, root: string, links: Map<string, Visual[]>, joints: Joint[]}}
 */
export function readUrdf(text) {
  const robot = new DOMParser().parseFromString(text, "text/xml").documentElement;
  if (robot.nodeName !== "robot") throw new Error(say("urdf.none"));
  const colours = new Map(children(robot, "material").map((each) => [each.getAttribute("name"), colourOf(each)]));
  const links = new Map(children(robot, "link").map((link) => [link.getAttribute("name"), children(link, "visual").map((each) => visual(each, colours))]));
  const joints = children(robot, "joint").map(joint).filter(({ parent, child }) => links.has(parent) && links.has(child));
  const below = new Set(joints.map(({ child }) => child));
  const root = [...links.keys()].find((name) => !below.has(name));
  if (!root) throw new Error(say("urdf.rootless"));
  return { name: robot.getAttribute("name") ?? "", root, links, joints };
}

const children = (element, name) => [...element.children].filter((each) => each.nodeName === name);
const child = (element, name) => children(element, name)[0];

function numbers(element, name, otherwise) {
  const text = (element?.getAttribute(name) ?? "").trim();
  const found = text.split(/\s+/).map(Number);
  return text && found.length === otherwise.length && found.every(Number.isFinite) ? found : otherwise;
}

function colourOf(material) {
  const colour = child(material, "color");
  return colour ? numbers(colour, "rgba", [0.7, 0.7, 0.7, 1]) : null;
}

function visual(element, colours) {
  const origin = child(element, "origin");
  const material = child(element, "material");
  const shape = child(element, "geometry")?.children[0];
  const kind = shape?.nodeName ?? "";
  const sizes = {
    box: () => numbers(shape, "size", [1, 1, 1]),
    sphere: () => numbers(shape, "radius", [1]),
    cylinder: () => [...numbers(shape, "radius", [1]), ...numbers(shape, "length", [1])],
    capsule: () => [...numbers(shape, "radius", [1]), ...numbers(shape, "length", [1])],
    mesh: () => numbers(shape, "scale", [1, 1, 1]),
  };
  return {
    kind, size: sizes[kind]?.() ?? [], uri: shape?.getAttribute("filename") ?? "",
    xyz: numbers(origin, "xyz", [0, 0, 0]), rpy: numbers(origin, "rpy", [0, 0, 0]),
    colour: (material && (colourOf(material) ?? colours.get(material.getAttribute("name")))) ?? null,
  };
}

function joint(element) {
  const origin = child(element, "origin");
  const mimic = child(element, "mimic");
  return {
    name: element.getAttribute("name") ?? "", type: element.getAttribute("type") ?? "fixed",
    parent: child(element, "parent")?.getAttribute("link") ?? "", child: child(element, "child")?.getAttribute("link") ?? "",
    xyz: numbers(origin, "xyz", [0, 0, 0]), rpy: numbers(origin, "rpy", [0, 0, 0]), axis: numbers(child(element, "axis"), "xyz", [1, 0, 0]),
    mimic: mimic && { joint: mimic.getAttribute("joint") ?? "", multiplier: numbers(mimic, "multiplier", [1])[0], offset: numbers(mimic, "offset", [0])[0] },
  };
}
