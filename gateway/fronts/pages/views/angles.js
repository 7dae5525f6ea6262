// SPDX-License-Identifier: Apache-2.0

/** Return roll, pitch and yaw of an orientation in radians, or null if it says none. */
export function anglesOf({ x, y, z, w }) {
  const size = Math.hypot(x, y, z, w);
  if (!(size > 0.1)) return null; // of no rotation: an IMU that has no orientation often leaves it zero
  const [a, b, c, d] = [x, y, z, w].map((each) => each / size);
  return {
    roll: Math.atan2(2 * (d * a + b * c), 1 - 2 * (a * a + b * b)),
    pitch: Math.asin(Math.max(-1, Math.min(1, 2 * (d * b - c * a)))),
    yaw: Math.atan2(2 * (d * c + a * b), 1 - 2 * (b * b + c * c)),
  };
}
