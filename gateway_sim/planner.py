# SPDX-License-Identifier: Apache-2.0
"""Ways around what stands in the room: A* on a grid, then as few corners as possible.

Pure and deterministic. Steps and lines are checked only by the distance to the nearest surface.
A way that starts on free floor and stays away from every surface cannot get into an obstacle.
"""

import heapq
import itertools
import math
from typing import Final, NamedTuple

import numpy as np

from gateway_sim.world import FloatArray, Point, World

CELL: Final = 0.1  # m: the whole room is 3000 cells, searched in about 10 ms
MARGIN: Final = 0.05  # m that a way keeps besides the robot's radius, for what cuts its corners
_DIAGONAL: Final = math.sqrt(2) * CELL
_REACH: Final = 0.8  # m from a cell to a start or a goal that is too near to something for a cell
_HERE: Final = 0.05  # m: no way is needed for so little
_SAMPLE: Final = 0.005  # m between the checks of a line, which miss 0.02 mm at a corner

_Cell = tuple[int, int]  # column, row
_STEPS: Final = tuple(
    (dx, dy) for dx, dy in itertools.product((-1, 0, 1), repeat=2) if (dx, dy) != (0, 0)
)


class _Open(NamedTuple):
    """A cell to look at, the most promising one first."""

    expected: float  # m from the start to the goal by this cell
    walked: float
    cell: _Cell
    before: _Cell | None


class Planner:
    """Plans ways of a robot with a radius, in metres, through a world that never changes."""

    def __init__(self, world: World, radius: float) -> None:
        self._world = world
        self._radius = radius
        self._xs = np.arange(world.x_min + CELL / 2, world.x_max, CELL)
        self._ys = np.arange(world.y_min + CELL / 2, world.y_max, CELL)
        centres = np.stack(np.meshgrid(self._xs, self._ys, indexing="ij"), axis=-1)
        # between two neighbours nothing is nearer to a surface than by half their distance
        room = radius + MARGIN + _DIAGONAL / 2
        nearest = world.distances(centres.reshape(-1, 2)).reshape(centres.shape[:2])
        self._is_free = nearest >= room
        self._cells: FloatArray = np.argwhere(self._is_free).astype(float)

    def plan(self, start: Point, goal: Point) -> list[Point] | None:
        """Return the corners of a way, the goal as the last one, or ``None`` if there is no way.

        Both ends must be free floor with room for the robot. The way keeps `MARGIN` from all
        things, except where an end is too near to one for that.
        """
        if math.dist(start, goal) < _HERE or self._is_line(start, goal, MARGIN):
            return [goal]
        first, last = self._cell_near(start), self._cell_near(goal)
        if first is None or last is None:
            return None
        cells = self._search(first, last)
        if cells is None:
            return None
        return self._straightened([start, *map(self._centre, cells), goal])[1:]

    def _centre(self, cell: _Cell) -> Point:
        return float(self._xs[cell[0]]), float(self._ys[cell[1]])

    def _is_line(self, start: Point, end: Point, margin: float) -> bool:
        """Return whether the robot can drive straight, from free floor."""
        count = 2 + math.ceil(math.dist(start, end) / _SAMPLE)
        points = np.linspace(start, end, count)
        return bool((self._world.distances(points) >= self._radius + margin).all())

    def _cell_near(self, place: Point) -> _Cell | None:
        """Return the nearest cell to which the robot can drive straight."""
        corner = (float(self._xs[0]), float(self._ys[0]))
        away = np.hypot(*(self._cells * CELL + corner - place).T)
        for index in np.argsort(away, kind="stable"):
            if away[index] > _REACH:
                break
            column, row = self._cells[index]
            cell = (int(column), int(row))
            if self._is_line(place, self._centre(cell), 0.0):
                return cell
        return None

    def _search(self, first: _Cell, last: _Cell) -> list[_Cell] | None:
        """Find the shortest way over free cells (Hart, Nilsson and Raphael, 1968)."""
        before: dict[_Cell, _Cell | None] = {}
        candidates = [_Open(0.0, 0.0, first, None)]
        while candidates:
            here = heapq.heappop(candidates)
            if here.cell in before:
                continue
            before[here.cell] = here.before
            if here.cell == last:
                return _traced(before, last)
            for cell in self._neighbours(here.cell):
                if cell not in before:
                    walked = here.walked + math.dist(here.cell, cell)
                    left = math.dist(cell, last)
                    heapq.heappush(candidates, _Open(walked + left, walked, cell, here.cell))
        return None

    def _neighbours(self, cell: _Cell) -> list[_Cell]:
        columns, rows = self._is_free.shape
        around = ((cell[0] + dx, cell[1] + dy) for dx, dy in _STEPS)
        return [
            (x, y) for x, y in around if 0 <= x < columns and 0 <= y < rows and self._is_free[x, y]
        ]

    def _straightened(self, points: list[Point]) -> list[Point]:
        """Leave out the points that a straight line passes by."""
        kept = [points[0]]
        for here, after in itertools.pairwise(points[1:]):
            if not self._is_line(kept[-1], after, MARGIN):
                kept.append(here)
        return [*kept, points[-1]]


def _traced(before: dict[_Cell, _Cell | None], last: _Cell) -> list[_Cell]:
    cells: list[_Cell] = []
    cell: _Cell | None = last
    while cell is not None:
        cells.append(cell)
        cell = before[cell]
    return cells[::-1]
