// SPDX-License-Identifier: Apache-2.0
// The floor, and where the robot's metres are: ROS has x forward, y left and z up (REP 103), WebXR x right, y up and -z forward.

import { Vector3 } from "../vendor/three.js";

const FARTHEST_M = 20; // a ray that is as good as level points at nothing in particular
const direction = new Vector3();

/** Turn a group so that its children are placed in the robot's metres. */
export function asRos(group) {
  group.quaternion.set(-0.5, 0.5, 0.5, 0.5);
  return group;
}

/** Return a place of the room's floor in the robot's metres. */
export const toRos = ({ x, z }) => ({ x: -z, y: -x });

/**
 * Put into *place* where a ray meets the floor, which has no edges. Return whether it does.
 * @param {import("../vendor/three.js").Ray} ray
 * @param {import("../vendor/three.js").Vector3} place
 */
export function meet(ray, place) {
  if (ray.direction.y >= 0 || ray.origin.y <= 0) return false;
  const length = -ray.origin.y / ray.direction.y;
  if (length > FARTHEST_M) return false;
  place.copy(ray.origin).addScaledVector(ray.direction, length);
  return true;
}

/**
 * Return the place of the room where a ray that comes down to the floor is as high as the blocks of a map, in the robot's metres.
 * @param {import("../vendor/three.js").Ray} ray
 * @param {number} high
 */
export function entry(ray, high) {
  const length = Math.max(0, (ray.origin.y - high) / -ray.direction.y);
  return toRos({ x: ray.origin.x + ray.direction.x * length, z: ray.origin.z + ray.direction.z * length });
}

/** Let a ray begin where an object is, and point where it points: to its -z. */
export function along(object, ray) {
  object.updateWorldMatrix(true, false);
  ray.origin.setFromMatrixPosition(object.matrixWorld);
  ray.direction.copy(direction.set(0, 0, -1).transformDirection(object.matrixWorld));
}
