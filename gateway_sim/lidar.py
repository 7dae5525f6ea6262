# SPDX-License-Identifier: Apache-2.0
"""The simulated lidar: 360 beams around the robot, like a TurtleBot3's LDS-01."""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gateway_sim.world import Pose, World

BEAMS: Final = 360
ANGLE_INCREMENT: Final = math.tau / BEAMS  # rad, counter-clockwise, the first beam straight ahead
RANGE_MIN: Final = 0.12  # m
RANGE_MAX: Final = 3.5  # m
SCAN_NS: Final = 200_000_000  # one turn of the mirror: 5 Hz
_NOISE: Final = 0.005  # m, standard deviation


class Lidar:
    """Measures distances in a world, with a little noise from *seed*."""

    def __init__(self, world: World, seed: int = 0) -> None:
        self._world = world
        self._random = np.random.default_rng(seed)
        self._angles = np.arange(BEAMS) * ANGLE_INCREMENT

    def scan(self, pose: Pose) -> NDArray[np.float32]:
        """Return the range of each beam, in metres.

        REP 117: too near is negative infinity, too far is positive infinity.
        """
        angles = pose.heading + self._angles
        hits = self._world.cast(pose.x, pose.y, np.cos(angles), np.sin(angles))
        ranges = hits.distance.min(axis=0) + self._random.normal(0.0, _NOISE, BEAMS)
        ranges[ranges > RANGE_MAX] = np.inf
        ranges[ranges < RANGE_MIN] = -np.inf
        measured: NDArray[np.float32] = ranges.astype(np.float32)
        return measured
