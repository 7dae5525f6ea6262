# SPDX-License-Identifier: Apache-2.0
"""Ways keep off everything, or there is none."""

import itertools
import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from gateway_sim.planner import Planner
from gateway_sim.robot import RADIUS
from gateway_sim.world import Bay, Obstacle, World, furnished_room

WORLD = furnished_room()
PLANNER = Planner(WORLD, RADIUS)
PLACES = st.tuples(st.floats(WORLD.x_min, WORLD.x_max), st.floats(WORLD.y_min, WORLD.y_max))
BEHIND_THE_PARTITION = ((1.4, 2.0), (2.4, 2.0))


def clearances(start, way):
    """Return the clearance of the floor under a way each 7 mm, in pieces of a line."""
    for a, b in itertools.pairwise([start, *way]):
        count = 2 + int(math.dist(a, b) / 0.007)
        for k in range(count + 1):
            share = k / count
            yield WORLD.clearance(a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]))


@given(start=PLACES, goal=PLACES)
def test_from_any_free_place_to_any_other_the_way_keeps_off_everything(start, goal):
    assume(WORLD.clearance(*start) >= RADIUS + 1e-3)
    assume(WORLD.clearance(*goal) >= RADIUS + 1e-3)
    way = PLANNER.plan(start, goal)
    if way is None:  # it is enclosed: somewhere it is too narrow for a margin
        assert min(WORLD.clearance(*start), WORLD.clearance(*goal)) < RADIUS + 0.1
        return
    assert way[-1] == goal
    assert min(clearances(start, way)) >= RADIUS - 1e-4


def test_the_way_around_the_partition_has_few_corners_and_a_margin():
    start, goal = BEHIND_THE_PARTITION
    way = PLANNER.plan(start, goal)
    assert 2 <= len(way) <= 5
    assert min(clearances(start, way)) >= RADIUS + 0.049
    length = sum(math.dist(a, b) for a, b in itertools.pairwise([start, *way]))
    assert 2.2 < length < 3.2, "some 1.2 m down, and up again"


def test_a_free_line_is_the_way():
    assert PLANNER.plan((0.0, 0.0), (2.0, 0.1)) == [(2.0, 0.1)]


def test_the_same_way_is_planned_each_time():
    assert PLANNER.plan(*BEHIND_THE_PARTITION) == Planner(WORLD, RADIUS).plan(*BEHIND_THE_PARTITION)


def divided(gap):
    """Return a planner for a room with a wall from side to side that has a gap."""
    walls = [
        Obstacle(
            "left", ((-0.1, gap / 2), (0.1, gap / 2), (0.1, 2.0), (-0.1, 2.0)), 1.0, (0, 0, 0)
        ),
        Obstacle(
            "right", ((-0.1, -2.0), (0.1, -2.0), (0.1, -gap / 2), (-0.1, -gap / 2)), 1.0, (0, 0, 0)
        ),
    ]
    return Planner(World((-2.0, -2.0), (2.0, 2.0), 1.0, walls, Bay(1.0, 1.0, 0.5, 0.5)), RADIUS)


@pytest.mark.parametrize(("gap", "leads"), [(0.8, True), (0.2, False)])
def test_through_a_gap_that_is_too_narrow_no_way_leads(gap, leads):
    way = divided(gap).plan((-1.0, 1.0), (1.0, 1.0))
    assert (way is not None) == leads


def test_no_way_leads_from_a_niche_whose_walls_are_too_near():
    # 0.3 m wide: room for the robot, and none for a margin
    niche = [
        Obstacle("west", ((-2.0, -2.0), (-0.15, -2.0), (-0.15, 1.0), (-2.0, 1.0)), 1.0, (0, 0, 0)),
        Obstacle("east", ((0.15, -2.0), (2.0, -2.0), (2.0, 1.0), (0.15, 1.0)), 1.0, (0, 0, 0)),
    ]
    world = World((-2.0, -2.0), (2.0, 2.0), 1.0, niche, Bay(1.0, 1.0, 0.5, 0.5))
    planner = Planner(world, RADIUS)
    assert planner.plan((0.0, -1.5), (1.0, 1.5)) is None
    assert planner.plan((0.0, 1.0), (1.0, 1.5)) is not None, "at its mouth"
