# SPDX-License-Identifier: Apache-2.0
"""A velocity: the six numbers of a Twist."""

import math
from typing import NamedTuple


class Velocity(NamedTuple):
    """Linear in m/s and angular in rad/s, both of x, y and z. All are finite."""

    linear_x: float = 0.0
    linear_y: float = 0.0
    linear_z: float = 0.0
    angular_x: float = 0.0
    angular_y: float = 0.0
    angular_z: float = 0.0

    @property
    def is_zero(self) -> bool:
        """Return whether it stops the robot."""
        return not any(self)

    @property
    def is_finite(self) -> bool:
        """Return whether it can be published at all."""
        return all(map(math.isfinite, self))

    def clamped(self, max_linear: float, max_angular: float) -> "Velocity":
        """Return it with neither speed above its limit. The directions stay."""
        linear = _shortened(self[:3], max_linear)
        angular = _shortened(self[3:], max_angular)
        return Velocity(*linear, *angular)


ZERO = Velocity()


def _shortened(vector: tuple[float, ...], limit: float) -> tuple[float, ...]:
    largest = max(map(abs, vector))
    # the largest first: the length of three huge numbers overflows
    if largest > limit:
        vector = tuple(part / largest * limit for part in vector)
    length = math.hypot(*vector)
    return vector if length <= limit else tuple(part / length * limit for part in vector)
