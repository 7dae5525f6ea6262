# SPDX-License-Identifier: Apache-2.0
"""Rigid transforms: a rotation by a unit quaternion, then a translation."""

import math
from typing import Final, NamedTuple

Vector = tuple[float, float, float]
# radians. Below, slerp divides by next to nothing, and lerp is as good
_SMALL_ANGLE: Final = 1e-4
_SHORTEST: Final = 1e-6  # of a quaternion that is meant. An unset one is 0 0 0 0


class Rigid(NamedTuple):
    """Metres, and the x, y, z, w of a unit quaternion."""

    x: float
    y: float
    z: float
    qx: float
    qy: float
    qz: float
    qw: float

    def after(self, first: "Rigid") -> "Rigid":
        """Return the transform that applies *first* and then this one."""
        x, y, z = self.rotate(first.x, first.y, first.z)
        ax, ay, az, aw = self[3:]
        bx, by, bz, bw = first[3:]
        return Rigid(
            self.x + x,
            self.y + y,
            self.z + z,
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
            aw * bw - ax * bx - ay * by - az * bz,
        )

    def inverse(self) -> "Rigid":
        """Return the transform that undoes this one."""
        back = Rigid(0.0, 0.0, 0.0, -self.qx, -self.qy, -self.qz, self.qw)
        x, y, z = back.rotate(self.x, self.y, self.z)
        return back._replace(x=-x, y=-y, z=-z)

    def rotate(self, x: float, y: float, z: float) -> Vector:
        """Rotate a vector, without moving it."""
        qx, qy, qz, qw = self[3:]
        # v + 2w (q x v) + 2 q x (q x v)
        tx = 2 * (qy * z - qz * y)
        ty = 2 * (qz * x - qx * z)
        tz = 2 * (qx * y - qy * x)
        return (
            x + qw * tx + qy * tz - qz * ty,
            y + qw * ty + qz * tx - qx * tz,
            z + qw * tz + qx * ty - qy * tx,
        )

    def towards(self, other: "Rigid", ratio: float) -> "Rigid":
        """Interpolate: 0 is this one, 1 the other. The rotation goes the short way (slerp)."""
        return Rigid(
            self.x + ratio * (other.x - self.x),
            self.y + ratio * (other.y - self.y),
            self.z + ratio * (other.z - self.z),
            *_slerp(self, other, ratio),
        )

    def distance(self, other: "Rigid") -> float:
        """Return the metres between the two translations."""
        return math.dist(self[:3], other[:3])

    def angle(self, other: "Rigid") -> float:
        """Return the radians, up to pi, of the rotation between the two."""
        apart = math.dist(self[3:], other[3:])
        # q and -q are the same rotation. The nearer one is the short way
        opposite = math.hypot(*(a + b for a, b in zip(self[3:], other[3:], strict=True)))
        # the arc cosine of their product would find no angle below 1e-8
        return 4 * math.atan2(min(apart, opposite), max(apart, opposite))

    def normalized(self) -> "Rigid":
        """Return the transform with a quaternion of length 1.

        Raises:
            ValueError: a number is not finite, or the quaternion has no direction.
        """
        length = math.hypot(*self[3:])
        if not (math.isfinite(length) and all(map(math.isfinite, self[:3]))):
            raise ValueError("a number is not finite")
        if length < _SHORTEST:
            raise ValueError("its quaternion has no direction")
        if length == 1.0:
            return self
        return Rigid(*self[:3], *(number / length for number in self[3:]))


IDENTITY: Final = Rigid(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)


def _slerp(one: Rigid, other: Rigid, ratio: float) -> tuple[float, float, float, float]:
    """Shoemake, Animating rotation with quaternion curves, SIGGRAPH 1985."""
    dot = sum(a * b for a, b in zip(one[3:], other[3:], strict=True))
    # q and -q are the same rotation. The nearer one is the short way
    sign = -1.0 if dot < 0 else 1.0
    angle = math.acos(min(1.0, abs(dot)))
    if angle < _SMALL_ANGLE:
        first, second = 1 - ratio, ratio
    else:
        first = math.sin((1 - ratio) * angle) / math.sin(angle)
        second = math.sin(ratio * angle) / math.sin(angle)
    x, y, z, w = (first * a + sign * second * b for a, b in zip(one[3:], other[3:], strict=True))
    length = math.hypot(x, y, z, w)
    return x / length, y / length, z / length, w / length
