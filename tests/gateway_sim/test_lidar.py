# SPDX-License-Identifier: Apache-2.0
"""The lidar measures what geometry says."""

import math

import numpy as np
import pytest

from gateway_sim.lidar import ANGLE_INCREMENT, BEAMS, RANGE_MAX, Lidar
from gateway_sim.world import Bay, Pose, World

NOISE = 0.03  # m, six standard deviations
ROOM = World((-1, -2), (3, 9), 1.0, [], Bay(x=2, y=1, depth=0.6, width=0.5))


def test_beams_run_counter_clockwise_from_straight_ahead():
    ranges = Lidar(ROOM).scan(Pose(0, 0, 0))
    assert ranges.shape == (360,)
    assert ranges.dtype == np.float32
    assert ranges[0] == pytest.approx(3, abs=NOISE)
    assert ranges[180] == pytest.approx(1, abs=NOISE)
    assert ranges[270] == pytest.approx(2, abs=NOISE)
    assert ranges[30] == pytest.approx(3 / math.cos(math.radians(30)), abs=NOISE)


def test_the_scan_turns_with_the_robot():
    lidar = Lidar(ROOM)
    # noise decides what is infinite where a wall is as far as the lidar sees
    straight = np.minimum(lidar.scan(Pose(0, 0, 0)), RANGE_MAX)
    turned = np.minimum(lidar.scan(Pose(0, 0, math.radians(90))), RANGE_MAX)
    assert turned == pytest.approx(np.roll(straight, -90), abs=2 * NOISE)


def test_a_point_too_far_is_infinite():
    assert Lidar(ROOM).scan(Pose(0, 0, 0))[90] == math.inf
    assert Lidar(ROOM).scan(Pose(0, 9 - 3.4, 0))[90] == pytest.approx(3.4, abs=NOISE)
    assert Lidar(ROOM).scan(Pose(0, 9 - 3.6, 0))[90] == math.inf


def test_a_point_too_near_is_negative_infinite():
    assert Lidar(ROOM).scan(Pose(-0.9, 0, 0))[180] == -math.inf


def test_noise_is_small_and_follows_the_seed():
    scans = [Lidar(ROOM, seed).scan(Pose(0, 0, 0)) for seed in (1, 1, 2)]
    seen = np.isfinite(scans[0]) & (scans[0] < RANGE_MAX - 0.1)
    differences = scans[0][seen] - scans[2][seen]
    assert 0.003 < differences.std() < 0.015
    assert np.abs(differences).max() < 2 * NOISE
    assert np.array_equal(scans[0], scans[1])
    assert not np.array_equal(scans[0], scans[2])


def test_a_turn_is_complete():
    assert pytest.approx(math.tau) == BEAMS * ANGLE_INCREMENT
