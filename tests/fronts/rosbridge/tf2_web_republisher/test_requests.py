# SPDX-License-Identifier: Apache-2.0
"""Requests to tf2_web_republisher, as its clients write them."""

import pytest

from gateway.core.errors import ProtocolError
from gateway.fronts.rosbridge.tf2_web_republisher.requests import (
    ActionGoal,
    GoalId,
    RepublishRequest,
    parse,
)

FRAMES = {"source_frames": ["a"], "target_frame": "b"}


def test_absent_fields_have_the_values_that_roslib_sends():
    request = parse(RepublishRequest, FRAMES, "args")
    assert (request.rate_hz, request.timeout_s) == (10.0, 2.0)
    assert (request.angular_thres, request.trans_thres) == (0.0, 0.0)


@pytest.mark.parametrize(("rate", "hz"), [(0, 10), (1e-320, 0.001), (0.001, 0.001), (200, 200)])
def test_a_rate_has_a_period_that_ends(rate: float, hz: float):
    assert parse(RepublishRequest, {**FRAMES, "rate": rate}, "args").rate_hz == hz


@pytest.mark.parametrize(
    ("timeout", "seconds"),
    [
        ({"secs": 1, "nsecs": 500_000_000}, 1.5),
        ({"sec": 60, "nanosec": 0}, 60),
        ({"sec": 0, "nanosec": 1}, 1e-9),
        ({"secs": 0, "nsecs": 0}, 2.0),
    ],
)
def test_a_timeout_has_the_names_of_either_ros(timeout: dict[str, int], seconds: float):
    assert parse(RepublishRequest, {**FRAMES, "timeout": timeout}, "args").timeout_s == seconds


def test_values_may_come_in_order():
    request = parse(RepublishRequest, [["a"], "b", 0.1, 0.2, 5, {"sec": 3}], "args")
    assert request == RepublishRequest(
        source_frames=("a",),
        target_frame="b",
        angular_thres=0.1,
        trans_thres=0.2,
        rate=5,
        timeout={"sec": 3},
    )


def test_null_is_as_left_out():
    assert parse(RepublishRequest, {**FRAMES, "rate": None}, "args").rate_hz == 10
    assert parse(GoalId, None, "msg").id == ""


@pytest.mark.parametrize(
    ("model", "values", "words"),
    [
        (RepublishRequest, {}, "args.source_frames: missing"),
        (RepublishRequest, {"source_frames": ["a"]}, "args.target_frame: missing"),
        (
            RepublishRequest,
            {**FRAMES, "source_frames": ["a"] * 513},
            "args.source_frames: expected at most 512 items, got 513",
        ),
        (
            RepublishRequest,
            {**FRAMES, "source_frames": "a"},
            "args.source_frames: expected an array, got 'a'",
        ),
        (
            RepublishRequest,
            {**FRAMES, "timeout": {"sec": 61}},
            "args.timeout: expected at most 60 s, got 61 s",
        ),
        (RepublishRequest, {**FRAMES, "rate": 201}, "args.rate: expected at most 200, got 201"),
        (RepublishRequest, {**FRAMES, "rate": -1}, "args.rate: expected at least 0, got -1"),
        (ActionGoal, {"goal": {}}, "args.goal_id: missing"),
        (GoalId, {"id": "x" * 257}, "args.id: expected at most 256 characters, got a string"),
        (GoalId, "x", "args: expected an object, or up to 1 value, got a string"),
    ],
)
def test_a_value_that_does_not_fit_is_refused_with_its_place(
    model: type[RepublishRequest], values: object, words: str
):
    with pytest.raises(ProtocolError) as caught:
        parse(model, values, "args")
    assert (caught.value.code, str(caught.value)) == ("invalid_value", words)


def test_the_header_and_the_stamp_of_ros_1_are_not_looked_at():
    message = {"header": {"seq": 1}, "goal_id": {"stamp": "now", "id": "x"}, "goal": 7}
    goal = parse(ActionGoal, message, "msg")
    assert parse(GoalId, goal.goal_id, "msg.goal_id").id == "x"
