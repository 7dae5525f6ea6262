# SPDX-License-Identifier: Apache-2.0
"""The parts of an action, of a package and made: each reads what the other has written."""

from typing import Any

import pytest
from rclpy.serialization import deserialize_message, serialize_message

from gateway.codec.error_text import CodecError
from gateway.codec.types import Types
from gateway.sources.rclpy.action_forms import ActionForm, PackageAction
from gateway.sources.rclpy.interfaces import action_class
from gateway.sources.source import RosError
from schemas.installed import InstalledDefinitions
from tests.messages import RandomMessages, ros_class, to_json, to_ros
from tests.sources.conftest import MadeClasses

DEFINITIONS = InstalledDefinitions()
TYPES = Types(DEFINITIONS)
ACTIONS = DEFINITIONS.names(kind="action")
GOAL_ID = bytes(range(16))
NOW_NS = 12 * 10**9 + 345
HEADER = b"\0\1\0\0"


@pytest.fixture(params=ACTIONS)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(params=["made to real", "real to made"])
def forms(name: str, request: pytest.FixtureRequest) -> tuple[ActionForm, ActionForm]:
    """The form that writes, and the one that reads."""
    real: ActionForm = PackageAction(name, action_class(name))
    made = MadeClasses().action(name)
    return (made, real) if request.param == "made to real" else (real, made)


def sent(message: Any, to: Any) -> Any:
    """Let rmw write a message of one class and read it as one of the other."""
    return deserialize_message(serialize_message(message), to)


def part(name: str, role: str, seed: int = 1) -> tuple[Any, bytes]:
    """Return a random part of an action, and its CDR."""
    full = f"{name}_{role}"
    values = RandomMessages(DEFINITIONS, seed).message(full)
    message = to_ros(DEFINITIONS.get(full), DEFINITIONS, values)
    return message, TYPES.get(full).encode(to_json(values), 0)


def test_a_goal(name: str, forms: tuple[ActionForm, ActionForm]):
    writes, reads = forms
    message, cdr = part(name, "Goal")
    request = sent(writes.to_goal_request(GOAL_ID, cdr), reads.send_goal.Request)
    goal_id, goal = reads.read_goal_request(request)
    assert (goal_id, deserialize_message(goal, type(message))) == (GOAL_ID, message)


@pytest.mark.parametrize("accepted_ns", [None, 0, NOW_NS])
def test_the_answer_to_a_goal(accepted_ns: int | None, forms: tuple[ActionForm, ActionForm]):
    writes, reads = forms
    response = sent(writes.to_goal_response(accepted_ns), reads.send_goal.Response)
    assert reads.is_accepted(response) is (accepted_ns is not None)


def test_the_time_of_acceptance(name: str):
    made, real_class = MadeClasses().action(name), action_class(name).Impl.SendGoalService.Response
    stamp = sent(made.to_goal_response(NOW_NS), real_class).stamp
    assert (stamp.sec, stamp.nanosec) == (12, 345)


def test_a_request_for_a_result(forms: tuple[ActionForm, ActionForm]):
    writes, reads = forms
    request = sent(writes.to_result_request(GOAL_ID), reads.get_result.Request)
    assert reads.read_result_request(request) == GOAL_ID


@pytest.mark.parametrize("seed", range(4))
def test_a_result(seed: int, name: str, forms: tuple[ActionForm, ActionForm]):
    writes, reads = forms
    message, cdr = part(name, "Result", seed)
    response = sent(writes.to_result_response(5, cdr), reads.get_result.Response)
    status, result = reads.read_result_response(response)
    assert (status, deserialize_message(result, type(message))) == (5, message)
    response = sent(writes.to_result_response(-1), reads.get_result.Response)
    status, result = reads.read_result_response(response)
    assert (status, deserialize_message(result, type(message))) == (-1, type(message)())


def received(form: ActionForm, cdr: bytes) -> Any:
    return deserialize_message(cdr, form.get_result.Response)


def test_a_big_endian_result():
    name = "test_msgs/action/Fibonacci"
    form = MadeClasses().action(name)
    cdr = b"\0\0\0\0" + b"\4\0\0\0" + b"\0\0\0\2" + b"\0\0\0\7\0\0\0\1"
    status, result = form.read_result_response(received(form, cdr))
    decoded = TYPES.get(f"{name}_Result").decode(result)
    assert (status, list(decoded["sequence"])) == (4, [7, 1])  # type: ignore[call-overload]


@pytest.mark.parametrize("body", [b"\4", b"\4\0\0\0\7", b"\4\0\0\0\1\0\0\0"])
def test_a_result_that_ends_too_early_is_refused_here_or_by_the_codec(body: bytes):
    name = "test_msgs/action/NestedMessage"
    form = MadeClasses().action(name)

    def read() -> None:
        _, result = form.read_result_response(received(form, HEADER + body))
        TYPES.get(f"{name}_Result").decode(result)

    with pytest.raises((RosError, CodecError)):
        read()


def test_requests_without_a_whole_id_have_a_short_one():
    form = MadeClasses().action("test_msgs/action/Fibonacci")
    request = deserialize_message(HEADER + b"abc", form.send_goal.Request)
    goal_id, goal = form.read_goal_request(request)
    assert (goal_id, goal) == (b"abc", HEADER)
    assert form.read_result_request(request) == b"abc"
    empty = deserialize_message(HEADER, form.send_goal.Response)
    assert form.is_accepted(empty) is False


def test_the_parts_have_the_names_of_the_package(name: str):
    made, real = MadeClasses().action(name), ros_class(name).Impl
    assert made.send_goal.__name__ == real.SendGoalService.__name__
    assert made.get_result.__name__ == real.GetResultService.__name__
    assert made.feedback.__name__ == real.FeedbackMessage.__name__
