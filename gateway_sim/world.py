# SPDX-License-Identifier: Apache-2.0
"""The room that the simulated robot drives in: walls, obstacles and a parking bay, in metres.

The frame is the map's (REP 105): x to the east, y to the north, the robot's start at the
origin. Everything in the room stands on the floor, upright, with a flat outline.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
Colour = tuple[int, int, int]  # red, green, blue
Point = tuple[float, float]

_ROUNDING: Final = 1e-9  # of a surface's length: no ray slips between two that touch


class Pose(NamedTuple):
    """A place on the floor and a heading, counter-clockwise from east, in radians."""

    x: float
    y: float
    heading: float


@dataclass(frozen=True, slots=True)
class Obstacle:
    """Something that stands in the room. Its convex outline runs counter-clockwise."""

    name: str
    outline: tuple[Point, ...]
    height: float
    colour: Colour


@dataclass(frozen=True, slots=True)
class Bay:
    """A rectangle on the floor to park in. Its open side is the one at lower x."""

    x: float  # centre
    y: float
    depth: float  # along x
    width: float  # along y

    def holds(self, pose: Pose) -> bool:
        """Return whether *pose* is parked: centred within 5 cm and straight within 10°."""
        return math.hypot(pose.x - self.x, pose.y - self.y) < 0.05 and abs(
            math.remainder(pose.heading, math.tau)
        ) < math.radians(10)


class Hits(NamedTuple):
    """The points where rays meet surfaces: arrays of shape (surfaces, rays)."""

    distance: FloatArray  # in lengths of the ray's direction, infinite if the ray misses
    along: FloatArray  # metres from the surface's left edge, as seen from the ray's origin


class World:
    """A rectangular room and the things in it, which never change.

    A *surface* is one upright face, seen from one side only: first the room's four walls, then
    the obstacles' faces. Seen from the front it runs from its start on the left to its end on
    the right.
    """

    def __init__(
        self,
        corner: Point,
        opposite: Point,
        height: float,
        obstacles: Sequence[Obstacle],
        bay: Bay,
    ) -> None:
        self.x_min, self.y_min = corner
        self.x_max, self.y_max = opposite
        self.height = height
        self.obstacles = tuple(obstacles)
        self.bay = bay
        # Clockwise, so that the walls' fronts face into the room.
        west, east, south, north = self.x_min, self.x_max, self.y_min, self.y_max
        walls = ((west, north), (east, north), (east, south), (west, south))
        outlines = [walls, *(obstacle.outline for obstacle in obstacles)]
        self.starts: FloatArray = np.array([point for outline in outlines for point in outline])
        self.ends: FloatArray = np.array(
            [point for outline in outlines for point in (*outline[1:], outline[0])]
        )
        self._edges = self.ends - self.starts
        self._squared_lengths = np.einsum("ij,ij->i", self._edges, self._edges)

    def cast(self, x: float, y: float, dx: FloatArray, dy: FloatArray) -> Hits:
        """Send rays from a free place. *dx* and *dy* are their directions, of any length."""
        to_start = self.starts - (x, y)
        edge_x, edge_y = self._edges[:, :1], self._edges[:, 1:]
        # From the front, a surface turns clockwise against the ray: rays meet only those.
        facing = edge_y * dx - edge_x * dy
        with np.errstate(divide="ignore", invalid="ignore"):
            distance = (to_start[:, :1] * edge_y - to_start[:, 1:] * edge_x) / facing
            share = (to_start[:, :1] * dy - to_start[:, 1:] * dx) / facing
            inside = (share >= -_ROUNDING) & (share <= 1 + _ROUNDING)
            met = (facing < 0) & (distance > 0) & inside
        lengths = np.sqrt(self._squared_lengths)[:, None]
        return Hits(np.where(met, distance, np.inf), np.where(met, share * lengths, 0.0))

    def clearance(self, x: float, y: float) -> float:
        """Return the distance to the nearest surface, negative if the place is not free."""
        nearest = float(self.distances(np.array([[x, y]]))[0])
        return nearest if self._is_free(x, y) else -nearest

    def occupancy(self, resolution: float) -> NDArray[np.int8]:
        """Draw the map: a cell is 100 if something stands there, else 0. Row 0 is the south.

        The cells cover the room and one cell beyond each wall, so that the walls show.
        """
        xs = np.arange(self.x_min - resolution / 2, self.x_max + resolution, resolution)
        ys = np.arange(self.y_min - resolution / 2, self.y_max + resolution, resolution)
        centres = np.stack(np.meshgrid(xs, ys), axis=-1).reshape(-1, 2)
        taken = self.distances(centres) < resolution * 0.75
        taken |= np.array([not self._is_free(x, y) for x, y in centres])
        return np.where(taken, 100, 0).astype(np.int8).reshape(len(ys), len(xs))

    def distances(self, points: FloatArray) -> FloatArray:
        """Return for each point, shape (n, 2), the distance to the nearest surface.

        Unlike `clearance` it is positive also for what is not free.
        """
        offsets = points[:, None, :] - self.starts
        shares = np.einsum("ijk,jk->ij", offsets, self._edges) / self._squared_lengths
        feet = np.clip(shares, 0, 1)[:, :, None] * self._edges
        nearest: FloatArray = np.sqrt(((offsets - feet) ** 2).sum(axis=2).min(axis=1))
        return nearest

    def _is_free(self, x: float, y: float) -> bool:
        return (
            self.x_min < x < self.x_max
            and self.y_min < y < self.y_max
            and not any(_encloses(obstacle.outline, x, y) for obstacle in self.obstacles)
        )


def _encloses(outline: Sequence[Point], x: float, y: float) -> bool:
    return all(
        (bx - ax) * (y - ay) - (by - ay) * (x - ax) >= 0
        for (ax, ay), (bx, by) in zip(outline, (*outline[1:], outline[0]), strict=True)
    )


def _box(x: float, y: float, width: float, depth: float, degrees: float = 0) -> tuple[Point, ...]:
    cosine, sine = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return tuple(
        (x + cosine * u - sine * v, y + sine * u + cosine * v)
        for u, v in (
            (-width / 2, -depth / 2),
            (width / 2, -depth / 2),
            (width / 2, depth / 2),
            (-width / 2, depth / 2),
        )
    )


def _pillar(x: float, y: float, radius: float) -> tuple[Point, ...]:
    sides = 12  # round enough for a lidar with beams 1° apart
    return tuple(
        (x + radius * math.cos(math.tau * i / sides), y + radius * math.sin(math.tau * i / sides))
        for i in range(sides)
    )


START: Final = Pose(0.0, 0.0, 0.0)


def furnished_room() -> World:
    """Return the room of the demonstration: 6 m by 5 m, the bay ahead and to the right."""
    return World(
        (-2.0, -2.5),
        (4.0, 2.5),
        height=1.2,
        obstacles=(
            Obstacle("partition", _box(1.9, 1.75, 0.12, 1.5), 0.7, (214, 196, 158)),
            Obstacle("red crate", _box(1.7, -1.5, 0.5, 0.5, degrees=25), 0.45, (196, 64, 52)),
            Obstacle("blue crate", _box(-1.1, 1.5, 0.7, 0.4, degrees=-15), 0.4, (52, 96, 178)),
            Obstacle("green crate", _box(3.6, 1.9, 0.4, 0.5), 0.5, (66, 142, 84)),
            Obstacle("yellow pillar", _pillar(0.4, 1.3, 0.15), 0.9, (226, 178, 44)),
            Obstacle("violet pillar", _pillar(-0.9, -1.5, 0.2), 0.9, (130, 84, 160)),
        ),
        bay=Bay(x=3.6, y=-0.7, depth=0.6, width=0.5),
    )
