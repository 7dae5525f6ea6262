# SPDX-License-Identifier: Apache-2.0
"""The simulated camera: a pinhole camera on the robot that looks at the painted room.

Surfaces are upright and the camera is level, so each column of the picture meets a surface in one
vertical line: one ray per column finds it, and OpenCV looks up all pixels at once. The lens is
shifted downwards rather than tilted, which shows the floor from 0.36 m ahead.
"""

import math
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from gateway_sim.textures import FLOOR_SCALES, SKY_ROWS, WALL_SCALE, Picture, paint
from gateway_sim.world import Pose, World

WIDTH: Final = 640
HEIGHT: Final = 480
FOCAL_LENGTH: Final = 420.0  # pixels: 75° wide
CENTRE_X: Final = (WIDTH - 1) / 2  # pixels, where the optical axis meets the picture
CENTRE_Y: Final = 200.0
AHEAD: Final = 0.08  # m from the robot's centre to the lens
ABOVE: Final = 0.24  # m from the floor to the lens

_OBSTACLES_DEEP: Final = 4  # behind so many, a column shows only the room's wall
_FLOOR_NEAR: Final = (1.0, 2.2)  # m ahead where the floor's next coarser resolution begins

_Maps = NDArray[np.float32]


class Camera:
    """Draws the robot's view. One picture takes a few milliseconds of one core."""

    def __init__(self, world: World) -> None:
        self._world = world
        self._atlas = paint(world)
        self._horizon = math.floor(CENTRE_Y) + 1  # the first row that looks downwards
        self._rows = np.arange(HEIGHT, dtype=np.float32)[:, None]
        self._left = (CENTRE_X - np.arange(WIDTH, dtype=np.float64)) / np.float64(FOCAL_LENGTH)
        obstacles = [o.height for o in world.obstacles for _ in o.outline]
        self._heights = np.array([world.height] * 4 + obstacles)
        self._left_edges = np.array([place.x for place in self._atlas.surfaces], float)
        self._top_edges = np.array([place.y for place in self._atlas.surfaces], float)
        self._map_x: _Maps = np.empty((HEIGHT, WIDTH), np.float32)
        self._map_y: _Maps = np.empty((HEIGHT, WIDTH), np.float32)
        self._prepare_floor()

    def draw(self, pose: Pose) -> Picture:
        """Return the view of a robot at *pose*: 480 rows of 640 RGB pixels."""
        cosine, sine = math.cos(pose.heading), math.sin(pose.heading)
        x, y = pose.x + AHEAD * cosine, pose.y + AHEAD * sine
        # One metre along the optical axis: then a ray's length is a surface's depth.
        dx, dy = cosine - self._left * sine, sine + self._left * cosine
        self._map_sky()
        self._map_floor(x, y, dx, dy)
        self._map_surfaces(x, y, dx, dy)
        picture = cv2.remap(self._atlas.picture, self._map_x, self._map_y, cv2.INTER_LINEAR)
        return np.asarray(picture, np.uint8)  # unchanged: only OpenCV's stubs have a wider type

    def _prepare_floor(self) -> None:
        """Compute for each row below the horizon its distance, and the floor that it shows."""
        rows = np.arange(self._horizon, HEIGHT)
        depths = FOCAL_LENGTH * ABOVE / (rows - CENTRE_Y)
        levels = np.searchsorted(_FLOOR_NEAR, depths)
        scales = np.array(FLOOR_SCALES)[levels]
        places_x = np.array([place.x for place in self._atlas.floors])[levels]
        places_y = np.array([place.y for place in self._atlas.floors])[levels]
        # half a pixel: OpenCV counts from the centres of pixels
        self._floor_x = places_x - 0.5 - self._world.x_min * scales
        self._floor_y = places_y - 0.5 - self._world.y_min * scales
        self._floor_scales = scales
        self._floor_steps = (depths * scales).astype(np.float32)

    def _map_sky(self) -> None:
        self._map_x[: self._horizon] = self._atlas.sky.x + 1
        self._map_y[: self._horizon] = self._atlas.sky.y + self._rows[: self._horizon] * (
            SKY_ROWS / self._horizon
        )

    def _map_floor(
        self, x: float, y: float, dx: NDArray[np.float64], dy: NDArray[np.float64]
    ) -> None:
        for place, floor, direction, target in (
            (x, self._floor_x, dx, self._map_x),
            (y, self._floor_y, dy, self._map_y),
        ):
            below = target[self._horizon :]
            np.multiply.outer(self._floor_steps, direction.astype(np.float32), out=below)
            below += (floor + place * self._floor_scales).astype(np.float32)[:, None]

    def _map_surfaces(
        self, x: float, y: float, dx: NDArray[np.float64], dy: NDArray[np.float64]
    ) -> None:
        depths, along = self._world.cast(x, y, dx, dy)
        columns = np.arange(WIDTH)
        layers = [np.argmin(depths[:4], axis=0)]
        obstacles = depths[4:]
        for _ in range(_OBSTACLES_DEEP):
            nearest = np.argmin(obstacles, axis=0)
            met = np.isfinite(obstacles[nearest, columns])
            if not met.any():
                break
            layers.append(nearest + 4)
            obstacles = obstacles.copy()
            obstacles[nearest, columns] = np.inf
        # far to near: the wall first, then the obstacles from the farthest
        for surface in (layers[0], *layers[:0:-1]):
            seen = np.flatnonzero(np.isfinite(depths[surface, columns]))
            span = slice(seen[0], seen[-1] + 1)
            chosen = surface[span]
            self._map_layer(
                span, chosen, depths[chosen, columns[span]], along[chosen, columns[span]]
            )

    def _map_layer(
        self,
        span: slice,
        surface: NDArray[np.intp],
        depth: NDArray[np.float64],
        along: NDArray[np.float64],
    ) -> None:
        """Map the rows of one surface per column, none where the depth is infinite."""
        missed = np.isinf(depth)
        depth = np.where(missed, 1.0, depth)
        height = self._heights[surface]
        top = CENTRE_Y - FOCAL_LENGTH * (height - ABOVE) / depth
        bottom = np.where(missed, -1.0, CENTRE_Y + FOCAL_LENGTH * ABOVE / depth)
        first = max(0, math.floor(np.min(top[~missed])))
        last = min(HEIGHT, math.ceil(bottom.max()) + 1)
        rows = self._rows[first:last]
        inside = (rows >= top.astype(np.float32)) & (rows <= bottom.astype(np.float32))
        step = (depth * (WALL_SCALE / FOCAL_LENGTH)).astype(np.float32)
        offset = (self._top_edges[surface] - 0.5 - top * step).astype(np.float32)
        columns = (self._left_edges[surface] - 0.5 + along * WALL_SCALE).astype(np.float32)
        np.copyto(self._map_y[first:last, span], rows * step + offset, where=inside)
        np.copyto(self._map_x[first:last, span], columns, where=inside)
