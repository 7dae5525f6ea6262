# SPDX-License-Identifier: Apache-2.0
"""The action that drives the simulated robot: the times that it keeps, and how each goal ends."""

import time

import pytest

from gateway_sim.any_types import AnyTypes
from gateway_sim.navigator import NAVIGATE, Navigator
from gateway_sim.robot import DismissedError, Robot
from gateway_sim.world import furnished_room
from tests.gateway_sim.asking import Asking
from tests.gateway_sim.ros import Watcher

AHEAD = {"pose": {"pose": {"position": {"x": 2.0}}}}
HERE = {"pose": {"pose": {"position": {"x": 0.0}}}}
SUCCEEDED, CANCELED, ABORTED = 4, 5, 6


@pytest.fixture(scope="module")
def types():
    types = AnyTypes([NAVIGATE])
    while not types.poll():
        pass
    return types


@pytest.fixture
def watcher():
    watcher = Watcher("navigating")
    yield watcher
    watcher.close()


class Driven(Asking):
    """A client, the action and the robot, which takes a step whenever the action is polled."""

    def __init__(self, watcher, types):
        node = watcher.node
        self.robot = Robot(furnished_room(), time.monotonic_ns())
        self.navigator = Navigator(node.context, node, self.robot, self._in_map)
        self.polls = 0
        self.navigator.open(types)
        form = types.action(NAVIGATE).form
        super().__init__(watcher, NAVIGATE, form, "navigate_to_pose", self._turn)

    def _in_map(self, frame_id, pose):
        if frame_id:
            raise DismissedError(f"frame {frame_id!r}")
        return pose

    def _turn(self):
        self.polls += 1
        self.robot.step(time.monotonic_ns())
        self.navigator.poll("map")


@pytest.fixture
def driven(watcher, types):
    driven = Driven(watcher, types)
    yield driven
    driven.navigator.close()


def test_a_goal_is_driven_to_until_it_is_reached(driven):
    assert driven.goal(1, AHEAD)
    driven.until(lambda: driven.robot.linear > 0.1)
    assert driven.goal(2, HERE)
    assert driven.result(1) == ABORTED
    assert driven.result(2) == SUCCEEDED
    assert driven.robot.goal is None


def test_a_goal_in_a_frame_without_a_place_is_rejected(driven):
    assert not driven.goal(1, {"pose": {"header": {"frame_id": "moon"}}})
    assert driven.robot.goal is None


def test_feedback_comes_a_few_times_a_second(driven):
    begun_ns = time.monotonic_ns()
    assert driven.goal(1, AHEAD)
    driven.watcher.until(lambda: driven.feedback(), driven.poll)
    for _ in range(30):
        driven.poll()
    wanted = driven.polls + 5
    driven.until(lambda: driven.polls > wanted)
    most = 2 + (time.monotonic_ns() - begun_ns) / 250e6
    assert 1 <= len(driven.feedback()) <= most
    values = driven.feedback()[0][1]
    assert values["distance_remaining"] == pytest.approx(2.0, abs=0.1)
    assert values["current_pose"]["header"]["frame_id"] == "map"
    remaining = values["estimated_time_remaining"]
    assert remaining["sec"] + remaining["nanosec"] / 1e9 == pytest.approx(2.0 / 0.22, rel=0.1)


def test_a_goal_that_is_canceled_ends_once_the_robot_stands(driven):
    assert driven.goal(1, AHEAD)
    driven.until(lambda: driven.robot.linear > 0.1)
    driven.cancel(bytes(16))
    assert driven.result(1) == CANCELED
    assert driven.robot.linear == driven.robot.angular == 0


def test_a_goal_that_is_canceled_ends_though_another_client_drives_on(driven):
    assert driven.goal(1, AHEAD)
    driven.until(lambda: driven.robot.linear > 0.1)
    driven.cancel(bytes(16))
    future = driven.ask_result(1)

    def drive_on():
        driven.robot.command(0.1, 1.0)
        driven.poll()

    driven.watcher.until(future.done, drive_on, "the result")
    assert driven.form.read_result_response(future.result())[0] == CANCELED
    assert driven.robot.linear > 0


@pytest.mark.parametrize(
    "stop",
    [
        lambda robot: robot.command(0.0, 0.0),
        lambda robot: robot.reset(),
        lambda robot: robot.switch_motors(False),
    ],
    ids=["a command", "a reset", "the motors"],
)
def test_any_other_stop_of_the_robot_aborts_its_goal(driven, stop):
    assert driven.goal(1, AHEAD)
    stop(driven.robot)
    assert driven.result(1) == ABORTED


def test_a_robot_that_leaves_aborts_its_goal(driven):
    assert driven.goal(1, AHEAD)
    driven.until(lambda: driven.status(1) == 2)
    driven.navigator.close()
    driven.watcher.until(lambda: driven.status(1) == ABORTED)
