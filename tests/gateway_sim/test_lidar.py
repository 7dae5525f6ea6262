# SPDX-License-Identifier: Apache-2.0
"""The lidar measures what geometry says."""

import math

import numpy as np
import pytest

from gateway_sim.lidar import ANGLE_INCREMENT, BEAMS, RANGE_MAX, Lidar
from gateway_sim.world import Bay, Pose, World

ROOM = World((-1, -2), (3, 9), 1.0, [], Bay(x=2, y=1, depth=0.6, width=0.5))


def test_beams_run_counter_clockwise_from_straight_ahead():
    ranges = Lidar(ROOM, noise=0).scan(Pose(0, 0, 0))
    assert ranges.shape == (360,)
    assert ranges.dtype == np.float32
    assert ranges[0] == pytest.approx(3)
    assert ranges[180] == pytest.approx(1)
    assert ranges[270] == pytest.approx(2)
    assert ranges[30] == pytest.approx(3 / math.cos(math.radians(30)))


def test_the_scan_turns_with_the_robot():
    lidar = Lidar(ROOM, noise=0)
    straight = lidar.scan(Pose(0, 0, 0))
    turned = lidar.scan(Pose(0, 0, math.radians(90)))
    assert turned == pytest.approx(np.roll(straight, -90), rel=1e-5)


def test_what_is_too_far_is_infinite():
    assert Lidar(ROOM, noise=0).scan(Pose(0, 0, 0))[90] == math.inf


def test_what_is_too_near_is_negative_infinite():
    assert Lidar(ROOM, noise=0).scan(Pose(-0.9, 0, 0))[180] == -math.inf


def test_noise_is_small_and_follows_the_seed():
    truth = Lidar(ROOM, noise=0).scan(Pose(0, 0, 0))
    scans = [Lidar(ROOM, seed).scan(Pose(0, 0, 0)) for seed in (1, 1, 2)]
    seen = np.isfinite(truth) & (truth < RANGE_MAX - 0.1)
    errors = scans[0][seen] - truth[seen]
    assert 0.002 < errors.std() < 0.01
    assert np.abs(errors).max() < 0.03
    assert np.array_equal(scans[0], scans[1])
    assert not np.array_equal(scans[0], scans[2])


def test_a_turn_is_complete():
    assert pytest.approx(math.tau) == BEAMS * ANGLE_INCREMENT
