// SPDX-License-Identifier: Apache-2.0
// The shapes of visualization_msgs/msg/Marker, by their numbers.

import {
  BoxGeometry, BufferAttribute, BufferGeometry, ConeGeometry, CylinderGeometry, DoubleSide, Group, InstancedMesh, Line, LineBasicMaterial,
  LineSegments, Matrix4, Mesh, MeshLambertMaterial, Points, PointsMaterial, Quaternion, SphereGeometry, Color, Vector3,
} from "../vendor/three.js";
import { label } from "./label.js";

const [ARROW, CUBE, SPHERE, CYLINDER, LINE_STRIP, LINE_LIST, CUBE_LIST, SPHERE_LIST, POINTS, TEXT] = Array(10).keys();
export const MESH = 10;
const [TRIANGLES, ARROW_STRIP] = [11, 12];
const MOST_POINTS = 200_000; // of one marker: further ones are not drawn
const ALONG_X = new Vector3(1, 0, 0);

const box = () => new BoxGeometry(1, 1, 1);
const ball = () => new SphereGeometry(0.5, 20, 14);

/** Return the object of a marker in its own frame. Throws if there is no such shape. */
export function shapeOf(marker) {
  const { type, scale, color, points } = marker;
  switch (type) {
    case ARROW: return points.length >= 2 ? between(points[0], points[1], scale, color) : arrow(scale.x, scale.y, scale.z, color);
    case CUBE: return scaled(new Mesh(box(), solid(color)), scale);
    case SPHERE: return scaled(new Mesh(ball(), solid(color)), scale);
    case CYLINDER: return scaled(new Mesh(new CylinderGeometry(0.5, 0.5, 1, 24).rotateX(Math.PI / 2), solid(color)), scale);
    case LINE_STRIP: return lines(Line, marker);
    case LINE_LIST: return lines(LineSegments, marker);
    case CUBE_LIST: return many(box(), marker);
    case SPHERE_LIST: return many(new SphereGeometry(0.5, 10, 7), marker);
    case POINTS: return dots(marker);
    case TEXT: return label(marker.text, scale.z, `#${new Color(color.r, color.g, color.b).getHexString()}`);
    case TRIANGLES: return triangles(marker);
    case ARROW_STRIP: return strip(marker);
    default: throw new RangeError(`its type is ${type}`);
  }
}

const solid = ({ r, g, b, a }) => new MeshLambertMaterial({ color: new Color(r, g, b), opacity: a, transparent: a < 1, side: DoubleSide });

function scaled(mesh, { x, y, z }) {
  mesh.scale.set(x, y, z);
  return mesh;
}

/** Return an arrow along x: its length, and the width and height of its head. */
function arrow(length, width, height, color) {
  const made = new Group();
  const material = solid(color);
  const shaft = new Mesh(new CylinderGeometry(0.25, 0.25, 0.77, 16).rotateZ(-Math.PI / 2).translate(0.385, 0, 0), material);
  const head = new Mesh(new ConeGeometry(0.5, 0.23, 16).rotateZ(-Math.PI / 2).translate(0.885, 0, 0), material);
  made.add(shaft, head);
  return scaled(made, { x: length, y: width, z: height });
}

/** Return an arrow from one place to another. The scale has the diameters of its shaft and its head, and perhaps the head's length. */
function between(from, to, { x: thin, y: thick, z: headLength }, color) {
  const way = new Vector3(to.x - from.x, to.y - from.y, to.z - from.z);
  const length = way.length();
  const tip = headLength > 0 ? Math.min(headLength, length) : length * 0.23;
  const made = new Group();
  const material = solid(color);
  const shaft = new Mesh(new CylinderGeometry(thin / 2, thin / 2, length - tip, 16).rotateZ(-Math.PI / 2).translate((length - tip) / 2, 0, 0), material);
  const head = new Mesh(new ConeGeometry(thick / 2, tip, 16).rotateZ(-Math.PI / 2).translate(length - tip / 2, 0, 0), material);
  made.add(shaft, head);
  made.position.set(from.x, from.y, from.z);
  if (length > 0) made.quaternion.setFromUnitVectors(ALONG_X, way.divideScalar(length));
  return made;
}

function strip({ points, scale, color }) {
  const made = new Group();
  for (let at = 1; at < Math.min(points.length, 1000); at += 1) made.add(between(points[at - 1], points[at], scale, color));
  return made;
}

/** Return a geometry of the points of a marker, with their colours if it has any. */
function geometryOf({ points, colors }) {
  const count = Math.min(points.length, MOST_POINTS);
  const places = new Float32Array(3 * count);
  for (let at = 0; at < count; at += 1) places.set([points[at].x, points[at].y, points[at].z], 3 * at);
  const geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(places, 3));
  if (colors.length < count || !count) return geometry;
  const rgb = new Float32Array(3 * count);
  for (let at = 0; at < count; at += 1) rgb.set([colors[at].r, colors[at].g, colors[at].b], 3 * at);
  return geometry.setAttribute("color", new BufferAttribute(rgb, 3));
}

function look(Material, geometry, { r, g, b, a }, more = {}) {
  const hasColours = Boolean(geometry.attributes.color);
  return new Material({ color: hasColours ? new Color(1, 1, 1) : new Color(r, g, b), vertexColors: hasColours, opacity: a, transparent: a < 1, ...more });
}

function lines(Kind, marker) {
  const geometry = geometryOf(marker);
  return new Kind(geometry, look(LineBasicMaterial, geometry, marker.color));
}

function dots(marker) {
  const geometry = geometryOf(marker);
  return new Points(geometry, look(PointsMaterial, geometry, marker.color, { size: Math.max(marker.scale.x, marker.scale.y) }));
}

function triangles(marker) {
  const geometry = geometryOf(marker);
  if (marker.colors.length && marker.colors.length * 3 === marker.points.length) geometry.deleteAttribute("color"); // one for each triangle is not drawn
  geometry.computeVertexNormals();
  return scaled(new Mesh(geometry, look(MeshLambertMaterial, geometry, marker.color, { side: DoubleSide })), marker.scale);
}

function many(geometry, { points, colors, color, scale: { x, y, z } }) {
  const count = Math.min(points.length, MOST_POINTS);
  const hasColours = colors.length >= count && count > 0;
  const mesh = new InstancedMesh(geometry, solid(hasColours ? { r: 1, g: 1, b: 1, a: color.a } : color), count);
  const [matrix, still, size] = [new Matrix4(), new Quaternion(), new Vector3(x, y, z)];
  for (let at = 0; at < count; at += 1) {
    mesh.setMatrixAt(at, matrix.compose(new Vector3(points[at].x, points[at].y, points[at].z), still, size));
    if (hasColours) mesh.setColorAt(at, new Color(colors[at].r, colors[at].g, colors[at].b));
  }
  return mesh;
}
