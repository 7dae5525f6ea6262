// SPDX-License-Identifier: Apache-2.0
// The shapes of visualization_msgs/msg/Marker, by their numbers.

import { say } from "../shared/language.js";
import {
  BoxGeometry, BufferAttribute, BufferGeometry, ConeGeometry, CylinderGeometry, DoubleSide, DynamicDrawUsage, Group, InstancedMesh, Line, LineBasicMaterial,
  LineSegments, Matrix4, Mesh, MeshLambertMaterial, Points, PointsMaterial, Quaternion, SphereGeometry, Color, Vector3,
} from "../vendor/three.js";
import { label } from "./label.js";

const [ARROW, CUBE, SPHERE, CYLINDER, LINE_STRIP, LINE_LIST, CUBE_LIST, SPHERE_LIST, POINTS, TEXT] = Array(10).keys();
export const MESH = 10;
const [TRIANGLES, ARROW_STRIP] = [11, 12];
const MOST_POINTS = 200_000; // of one marker: further ones are not drawn
const MOST_CORNERS = 1000; // of a strip of arrows, likewise
const ALONG_X = new Vector3(1, 0, 0);
const WHITE = { r: 1, g: 1, b: 1 };

/**
 * A shape: a marker whose `key` is the same can have the object that is there. `make` makes one, and `set` gives it all that changes.
 * @typedef {{key: (marker: any) => unknown, make: (marker: any) => any, set: (object: any, marker: any) => void}} Shape
 */

const solid = () => new MeshLambertMaterial({ side: DoubleSide });
const box = () => new BoxGeometry(1, 1, 1);
const nothing = () => "";

/** @type {Record<number, Shape>} */
const SHAPES = {
  [ARROW]: { key: nothing, make: arrow, set: setArrow },
  [CUBE]: whole(box),
  [SPHERE]: whole(() => new SphereGeometry(0.5, 20, 14)),
  [CYLINDER]: whole(() => new CylinderGeometry(0.5, 0.5, 1, 24).rotateX(Math.PI / 2)),
  [LINE_STRIP]: drawn((geometry) => new Line(geometry, new LineBasicMaterial())),
  [LINE_LIST]: drawn((geometry) => new LineSegments(geometry, new LineBasicMaterial())),
  [CUBE_LIST]: many(box),
  [SPHERE_LIST]: many(() => new SphereGeometry(0.5, 10, 7)),
  [POINTS]: drawn((geometry) => new Points(geometry, new PointsMaterial()), ({ material }, { scale }) => (material.size = Math.max(scale.x, scale.y))),
  [TEXT]: { key: ({ text }) => text, make: ({ text }) => label(text, 1), set: setText },
  [TRIANGLES]: drawn((geometry) => new Mesh(geometry, solid()), (mesh, { scale }) => {
    mesh.geometry.computeVertexNormals();
    mesh.scale.copy(scale);
  }),
  [ARROW_STRIP]: { key: ({ points }) => Math.min(points.length, MOST_CORNERS), make: strip, set: setStrip },
};

/** Return what has to stay the same of a marker for its object to be kept. */
export const keyOf = (marker) => `${marker.type} ${SHAPES[marker.type]?.key(marker)}`;

/** Return an object for a marker, in its own frame. Throws if there is no such shape. */
export function make(marker) {
  if (!SHAPES[marker.type]) throw new RangeError(say("marker.type", { type: marker.type }));
  return SHAPES[marker.type].make(marker);
}

/** Give an object the size, the places, and the colours of a marker. */
export const set = (object, marker) => SHAPES[marker.type].set(object, marker);

/** Give a material a colour. */
export function tint(material, { r, g, b }, a) {
  material.color.setRGB(r, g, b);
  material.opacity = a;
  if (material.transparent === a < 1) return;
  material.transparent = a < 1;
  material.needsUpdate = true;
}

/** Return what is not drawn of a marker, in words, or "". */
export function leftOut({ ns, id, type, points }) {
  const most = type === ARROW_STRIP ? MOST_CORNERS : MOST_POINTS;
  return points.length > most ? say("marker.points", { id, namespace: JSON.stringify(ns), most, count: points.length }) : "";
}

/** Return the shape of one body. @returns {Shape} */
function whole(geometry) {
  return {
    key: nothing,
    make: () => new Mesh(geometry(), solid()),
    set: (mesh, { scale, color }) => {
      mesh.scale.copy(scale);
      tint(mesh.material, color, color.a);
    },
  };
}

/** Return an arrow along x, as long and as thick as its parts are scaled. */
function arrow() {
  const material = solid();
  const [shaft, head] = [new CylinderGeometry(0.5, 0.5, 1, 16), new ConeGeometry(0.5, 1, 16)].map((each) => new Mesh(each.rotateZ(-Math.PI / 2), material));
  return new Group().add(shaft, head);
}

function setArrow(made, { points, scale: { x, y, z }, color }) {
  tint(made.children[0].material, color, color.a);
  if (points.length >= 2) {
    between(made, points[0], points[1], { x, y, z });
    return;
  }
  made.position.set(0, 0, 0);
  made.quaternion.identity();
  stretch(made, 0.77 * x, 0.23 * x, [y / 2, z / 2], [y, z]);
}

/** Lay an arrow from one place to another. The scale has the diameters of its shaft and its head, and perhaps the head's length. */
function between(made, from, to, { x: thin, y: thick, z: headLength }) {
  const way = new Vector3(to.x - from.x, to.y - from.y, to.z - from.z);
  const length = way.length();
  const tip = headLength > 0 ? Math.min(headLength, length) : length * 0.23;
  made.position.copy(from);
  if (length > 0) made.quaternion.setFromUnitVectors(ALONG_X, way.divideScalar(length));
  stretch(made, length - tip, tip, [thin, thin], [thick, thick]);
}

function stretch({ children: [shaft, head] }, long, tip, thin, thick) {
  shaft.scale.set(long, ...thin);
  shaft.position.x = long / 2;
  head.scale.set(tip, ...thick);
  head.position.x = long + tip / 2;
}

function strip({ points }) {
  const made = new Group();
  const first = arrow();
  for (let at = 1; at < Math.min(points.length, MOST_CORNERS); at += 1) made.add(at === 1 ? first : first.clone()); // they share all but their places
  return made;
}

function setStrip(made, { points, scale, color }) {
  made.children.forEach((each, at) => between(each, points[at], points[at + 1], scale));
  if (made.children.length) tint(made.children[0].children[0].material, color, color.a);
}

function setText(sprite, { scale: { z }, color }) {
  sprite.userData.shape ??= sprite.scale.clone();
  sprite.scale.copy(sprite.userData.shape).multiplyScalar(z);
  tint(sprite.material, color, 1);
  sprite.material.transparent = true; // around the letters
}

function countOf({ points }) {
  return Math.min(points.length, MOST_POINTS);
}

/** Return how many points each colour is for. 0: all have that of the marker. */
function pointsPerColour(marker) {
  const count = countOf(marker);
  if (!count) return 0;
  if (marker.colors.length >= count) return 1;
  return marker.type === TRIANGLES && marker.colors.length * 3 >= count ? 3 : 0;
}

function keyOfPoints(marker) {
  return `${countOf(marker)} ${pointsPerColour(marker)}`;
}

/** Return a shape of points, each perhaps with a colour. @returns {Shape} */
function drawn(build, more = (_object, _marker) => {}) {
  const make = (marker) => {
    const geometry = new BufferGeometry();
    const attribute = () => new BufferAttribute(new Float32Array(3 * countOf(marker)), 3).setUsage(DynamicDrawUsage);
    geometry.setAttribute("position", attribute());
    const made = build(geometry);
    if (!pointsPerColour(marker)) return made;
    geometry.setAttribute("color", attribute());
    made.material.vertexColors = true;
    return made;
  };
  const set = (object, marker) => {
    const { position, color } = object.geometry.attributes;
    const { points, colors } = marker;
    const each = pointsPerColour(marker);
    for (let at = 0; at < position.count; at += 1) {
      position.setXYZ(at, points[at].x, points[at].y, points[at].z);
      if (!each) continue;
      const { r, g, b } = colors[Math.floor(at / each)];
      color.setXYZ(at, r, g, b);
    }
    position.needsUpdate = true;
    if (each) color.needsUpdate = true;
    object.geometry.boundingSphere = null; // that of the points before
    tint(object.material, each ? WHITE : marker.color, marker.color.a);
    more(object, marker);
  };
  return { key: keyOfPoints, make, set };
}

/** Return a shape of equal bodies at points. @returns {Shape} */
function many(geometry) {
  const [matrix, still, size, place, colour] = [new Matrix4(), new Quaternion(), new Vector3(), new Vector3(), new Color()];
  return {
    key: keyOfPoints,
    make: (marker) => new InstancedMesh(geometry(), solid(), countOf(marker)),
    set: (mesh, marker) => {
      const { points, colors, color, scale } = marker;
      const hasColours = pointsPerColour(marker) === 1;
      size.copy(scale);
      for (let at = 0; at < mesh.count; at += 1) {
        mesh.setMatrixAt(at, matrix.compose(place.copy(points[at]), still, size));
        if (hasColours) mesh.setColorAt(at, colour.setRGB(colors[at].r, colors[at].g, colors[at].b));
      }
      mesh.instanceMatrix.needsUpdate = true;
      if (mesh.instanceColor) mesh.instanceColor.needsUpdate = true;
      mesh.boundingSphere = null; // that of the places before
      tint(mesh.material, hasColours ? WHITE : color, color.a);
    },
  };
}
