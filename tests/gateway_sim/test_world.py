# SPDX-License-Identifier: Apache-2.0
"""The room: rays, clearances and the map agree with its geometry."""

import math

import numpy as np
import pytest

from gateway_sim.world import START, Bay, Obstacle, Pose, World, furnished_room

BOX = Obstacle("box", ((1, -0.5), (2, -0.5), (2, 0.5), (1, 0.5)), 0.5, (255, 0, 0))
ROOM = World((-3, -2), (4, 2), 1.0, [BOX], Bay(x=3, y=1, depth=0.6, width=0.5))
NORTH, EAST, SOUTH, WEST = range(4)


def cast(x, y, *angles):
    hits = ROOM.cast(x, y, np.cos(angles), np.sin(angles))
    nearest = hits.distance.argmin(axis=0)
    rays = np.arange(len(angles))
    return nearest, hits.distance[nearest, rays], hits.along[nearest, rays]


def test_rays_meet_the_walls_where_geometry_says():
    nearest, distance, _ = cast(0, 0, math.pi / 2, math.pi, -math.pi / 2)
    assert list(nearest) == [NORTH, WEST, SOUTH]
    assert distance == pytest.approx([2, 3, 2])


def test_a_ray_meets_an_obstacle_before_the_wall_behind():
    nearest, distance, _ = cast(0, 0, 0.0)
    assert nearest[0] == 4 + 3, "the box's west face is the last of its outline"
    assert distance == pytest.approx([1])


def test_a_slanting_ray_is_as_long_as_pythagoras_says():
    _, distance, _ = cast(0, 0, math.atan2(2, -2))
    assert distance == pytest.approx([math.hypot(2, 2)])


def test_along_counts_from_the_left_as_seen_from_the_room():
    nearest, _, along = cast(3, 0.5, 0.0, math.pi / 2)
    assert list(nearest) == [EAST, NORTH]
    assert along == pytest.approx([1.5, 6])


def test_lengths_are_in_those_of_the_direction():
    hits = ROOM.cast(0, 0, np.array([0.0]), np.array([0.5]))
    assert hits.distance.min() == pytest.approx(4)


@pytest.mark.parametrize(
    ("x", "y", "clearance"),
    [
        (0, 0, 1),
        (-2.5, 0, 0.5),
        (0.9, 0.6, math.hypot(0.1, 0.1)),
        (1.5, 0.0, -0.5),
        (5, 0, -1),
    ],
)
def test_clearance_is_the_distance_to_the_nearest_surface(x, y, clearance):
    assert ROOM.clearance(x, y) == pytest.approx(clearance)


def test_the_map_shows_walls_obstacles_and_free_floor():
    resolution = 0.1
    grid = ROOM.occupancy(resolution)
    assert grid.shape == (42, 72)

    def at(x, y):
        return grid[
            math.floor((y - ROOM.y_min + resolution) / resolution),
            math.floor((x - ROOM.x_min + resolution) / resolution),
        ]

    assert at(0, 0) == 0
    assert at(1.5, 0.05) == 100
    assert at(3.99, 0.05) == 100
    assert at(-2.95, 1.0) == 100
    assert set(np.unique(grid)) == {0, 100}


def test_the_bay_holds_a_robot_that_is_centred_and_straight():
    bay = ROOM.bay
    assert bay.holds(Pose(3.03, 1.03, 0.1))
    assert not bay.holds(Pose(3.06, 1.0, 0.0))
    assert not bay.holds(Pose(3.0, 1.0, 0.2))


def test_the_furnished_room_has_room_at_the_start_and_in_the_bay():
    world = furnished_room()
    assert world.clearance(START.x, START.y) > 1
    assert world.clearance(world.bay.x, world.bay.y) > 0.3


def test_the_furnished_rooms_outlines_are_convex_and_counter_clockwise():
    for obstacle in furnished_room().obstacles:
        points = np.array(obstacle.outline)
        edges = np.roll(points, -1, axis=0) - points
        following = np.roll(edges, -1, axis=0)
        assert (edges[:, 0] * following[:, 1] - edges[:, 1] * following[:, 0] > 0).all()
