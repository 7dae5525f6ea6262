# SPDX-License-Identifier: Apache-2.0
"""The contract of the router for actions: the fake and rclpy."""

import asyncio
import struct
from collections.abc import Callable
from typing import Any

import pytest

from gateway.sources.actions import ABORTED, CANCELED, SUCCEEDED, GoalRequest
from gateway.sources.source import RosError
from tests.client import TIMEOUT_S, eventually, eventually_equal
from tests.sources.conftest import Robot
from tests.sources.test_contract import BAD_NAMES, refusals

pytestmark = pytest.mark.parts("actions")

FIBONACCI = "test_msgs/action/Fibonacci"
NESTED = "test_msgs/action/NestedMessage"
BAD_TYPES = [
    *("", "x", "test_msgs/Fibonacci", "test_msgs/action/Nothing", "none_msgs/action/Fibonacci"),
    *("test_msgs/msg/Fibonacci", "std_srvs/srv/SetBool", "test_msgs/action/Fibonacci\n"),
    "test_msgs/action/Fibonacci_Goal",
]


def goal(order: int) -> bytes:
    """Fibonacci_Goal."""
    return b"\0\1\0\0" + struct.pack("<i", order)


def sequence(*values: int) -> bytes:
    """Fibonacci_Result and Fibonacci_Feedback."""
    return b"\0\1\0\0" + struct.pack(f"<I{len(values)}i", len(values), *values)


def values_of(cdr: bytes) -> list[int]:
    (count,) = struct.unpack_from("<I", cdr, 4)
    return list(struct.unpack_from(f"<{count}i", cdr, 8))


def order_of(cdr: bytes) -> int:
    return int.from_bytes(cdr[4:8], "little")


def ignore(*_: object) -> None: ...


class Provider:
    """The requests to an action server."""

    def __init__(self) -> None:
        self.goals: list[GoalRequest] = []
        self.cancels: list[GoalRequest] = []

    @property
    def callbacks(
        self,
    ) -> tuple[Callable[[GoalRequest], None], Callable[[GoalRequest], None]]:
        return self.goals.append, self.cancels.append


async def soon(awaiting: Any) -> Any:
    async with asyncio.timeout(TIMEOUT_S):
        return await awaiting


async def eventually_within_a_turn(condition: Callable[[], bool]) -> None:
    async with asyncio.timeout(TIMEOUT_S):
        while not condition():  # noqa: ASYNC110  # sooner than anything can be answered
            await asyncio.sleep(0)


class Both:
    """One side of an action is the gateway's, the other outside."""

    def __init__(self, robot: Robot, provides: bool) -> None:
        self.provider = Provider()
        callbacks = self.provider.callbacks
        if provides:
            self.server: Any = robot.ros.actions.serve_action("/dock", FIBONACCI, *callbacks)
            self.client: Any = robot.world.add_action_client("/dock", FIBONACCI)
        else:
            self.server = robot.world.add_action_server("/dock", FIBONACCI, *callbacks)
            self.client = robot.ros.actions.action_client("/dock", FIBONACCI)

    async def started(self, order: int = 3, on_feedback: Any = ignore) -> tuple[Any, GoalRequest]:
        count = len(self.provider.goals)
        accepted = await soon(self.client.send_goal(goal(order), on_feedback))
        await eventually(lambda: len(self.provider.goals) > count)
        return accepted, self.provider.goals[-1]


@pytest.fixture(params=["client", "server"])
async def both(robot: Robot, request: pytest.FixtureRequest) -> Both:
    return Both(robot, provides=request.param == "server")


async def test_a_goal_gets_its_feedback_and_its_result(both: Both) -> None:
    feedback: list[bytes] = []
    accepted, request = await both.started(7, feedback.append)
    assert order_of(request.cdr) == 7
    request.feedback(sequence(0, 1))
    request.feedback(sequence(0, 1, 1))
    await eventually(lambda: len(feedback) == 2)
    assert [values_of(each) for each in feedback] == [[0, 1], [0, 1, 1]]
    request.finish(SUCCEEDED, sequence(0, 1, 1, 2))
    status, result = await soon(accepted.result())
    assert (status, values_of(result)) == (SUCCEEDED, [0, 1, 1, 2])


async def test_a_goal_may_be_aborted(both: Both) -> None:
    accepted, request = await both.started()
    request.finish(ABORTED, sequence(9))
    status, result = await soon(accepted.result())
    assert (status, values_of(result)) == (ABORTED, [9])


async def test_several_goals_run_side_by_side(both: Both) -> None:
    heard: dict[int, list[list[int]]] = {}

    def hear(order: int) -> Callable[[bytes], None]:
        return lambda cdr: heard.setdefault(order, []).append(values_of(cdr))

    running = [await both.started(order, hear(order)) for order in range(5)]
    for order, (_, request) in enumerate(running):
        request.feedback(sequence(order))
    await eventually(lambda: len(heard) == 5)
    assert heard == {order: [[order]] for order in range(5)}
    for order in (3, 0, 4, 1, 2):
        running[order][1].finish(SUCCEEDED, sequence(order))
    results = [await soon(accepted.result()) for accepted, _ in running]
    assert [values_of(result.cdr) for result in results] == [[0], [1], [2], [3], [4]]


async def test_a_cancelled_goal_ends_as_canceled(both: Both) -> None:
    accepted, request = await both.started()
    accepted.cancel()
    await eventually(lambda: both.provider.cancels == [request])
    request.finish(CANCELED, sequence(1))
    status, result = await soon(accepted.result())
    assert (status, values_of(result)) == (CANCELED, [1])


async def test_a_goal_may_succeed_though_it_is_being_canceled(both: Both) -> None:
    accepted, request = await both.started()
    accepted.cancel()
    await eventually(lambda: both.provider.cancels == [request])
    request.finish(SUCCEEDED, sequence(1))
    assert (await soon(accepted.result())).status == SUCCEEDED


async def test_cancelling_one_goal_leaves_the_others(both: Both) -> None:
    running = [await both.started(order) for order in range(3)]
    running[1][0].cancel()
    await eventually(lambda: both.provider.cancels == [running[1][1]])
    for _, request in running:
        request.finish(SUCCEEDED, sequence())
    assert [(await soon(accepted.result())).status for accepted, _ in running] == [SUCCEEDED] * 3
    assert len(both.provider.cancels) == 1


async def test_a_goal_is_cancelled_once(robot: Robot) -> None:
    both = Both(robot, provides=True)
    accepted, request = await both.started()
    accepted.cancel()
    accepted.cancel()
    other, _ = await both.started()
    other.cancel()
    await eventually(lambda: both.provider.goals[-1] in both.provider.cancels)
    assert both.provider.cancels.count(request) == 1


async def test_a_goal_that_nobody_cancels_cannot_end_as_canceled(robot: Robot) -> None:
    both = Both(robot, provides=True)
    accepted, request = await both.started()
    request.finish(CANCELED, sequence())
    assert (await soon(accepted.result())).status == ABORTED


async def test_a_goal_ends_once(robot: Robot) -> None:
    both = Both(robot, provides=True)
    feedback: list[bytes] = []
    accepted, request = await both.started(3, feedback.append)
    request.finish(SUCCEEDED, sequence(1))
    request.finish(ABORTED, sequence(2))
    request.feedback(sequence(3))
    assert await soon(accepted.result()) == (SUCCEEDED, sequence(1))
    _, its_request = await both.started(4, feedback.append)
    its_request.feedback(sequence(4))
    await eventually(lambda: bool(feedback))
    assert [values_of(each) for each in feedback] == [[4]]


async def test_feedback_from_within_the_acceptance_is_not_lost(robot: Robot) -> None:
    def on_goal(request: GoalRequest) -> None:
        request.feedback(sequence(1))
        request.finish(SUCCEEDED, sequence(2))

    feedback: list[bytes] = []
    robot.ros.actions.serve_action("/dock", FIBONACCI, on_goal, ignore)
    client = robot.ros.actions.action_client("/dock", FIBONACCI)
    accepted = await soon(client.send_goal(goal(3), feedback.append))
    assert values_of((await soon(accepted.result())).cdr) == [2]
    assert [values_of(each) for each in feedback] == [[1]]


async def test_a_result_may_be_asked_for_twice(both: Both) -> None:
    accepted, request = await both.started()
    request.finish(SUCCEEDED, sequence(1))
    assert await soon(accepted.result()) == await soon(accepted.result())


async def test_giving_up_on_a_result_leaves_the_goal(both: Both) -> None:
    accepted, request = await both.started()
    waiting = asyncio.ensure_future(accepted.result())
    await asyncio.sleep(0)
    waiting.cancel()
    request.finish(SUCCEEDED, sequence(1))
    assert (await soon(accepted.result())).status == SUCCEEDED
    assert both.provider.cancels == []


async def test_a_rejected_goal_does_not_exist(robot: Robot) -> None:
    provider = Provider()
    robot.world.add_action_server(
        "/dock", FIBONACCI, *provider.callbacks, accepts=lambda cdr: order_of(cdr) < 10
    )
    client = robot.ros.actions.action_client("/dock", FIBONACCI)
    assert await soon(client.send_goal(goal(10), ignore)) is None
    assert await soon(client.send_goal(goal(9), ignore)) is not None


async def test_a_goal_waits_for_its_server(robot: Robot) -> None:
    client = robot.ros.actions.action_client("/dock", FIBONACCI)
    sending = asyncio.ensure_future(client.send_goal(goal(3), ignore))
    await asyncio.sleep(0)
    provider = Provider()
    robot.world.add_action_server("/dock", FIBONACCI, *provider.callbacks)
    assert await soon(sending) is not None


async def test_a_server_that_vanishes_fails_its_goals(robot: Robot) -> None:
    both = Both(robot, provides=False)
    accepted, _ = await both.started()
    both.server.close()
    with pytest.raises(RosError, match="action /dock has gone") as caught:
        await soon(accepted.result())
    assert caught.value.code == "not_found"


async def test_closing_a_client_fails_what_it_waits_for(robot: Robot) -> None:
    both = Both(robot, provides=False)
    accepted, _ = await both.started()
    result = asyncio.ensure_future(accepted.result())
    waiting = robot.ros.actions.action_client("/nobody", FIBONACCI)
    sending = asyncio.ensure_future(waiting.send_goal(goal(3), ignore))
    await asyncio.sleep(0)
    both.client.close()
    waiting.close()
    for awaited, name in ((result, "/dock"), (sending, "/nobody")):
        with pytest.raises(RosError, match=f"client of action {name} is closed") as caught:
            await soon(awaited)
        assert caught.value.code == "not_found"
    accepted.cancel()
    with pytest.raises(RosError, match="client of action /dock is closed"):
        await soon(both.client.send_goal(goal(3), ignore))
    assert both.provider.cancels == []


@pytest.mark.parametrize("turns", range(4))  # the answer comes in any of them
@pytest.mark.parametrize("closes", [False, True])
async def test_a_goal_that_nobody_waits_for_is_cancelled_when_it_is_accepted(robot, closes, turns):
    both = Both(robot, provides=True)
    client = robot.ros.actions.action_client("/dock", FIBONACCI)
    sending = asyncio.ensure_future(client.send_goal(goal(3), ignore))
    await eventually_within_a_turn(lambda: bool(both.provider.goals) or sending.done())
    for _ in range(turns):
        await asyncio.sleep(0)
    accepted = None if sending.cancel() else await sending
    if accepted is not None:  # the answer was faster
        accepted.cancel()
    if closes:
        await eventually(sending.done)
        client.close()
    await eventually(lambda: bool(both.provider.goals))
    await eventually(lambda: both.provider.cancels == both.provider.goals)


async def test_a_goal_cancelled_right_before_its_client_closes_is_cancelled(robot: Robot) -> None:
    both = Both(robot, provides=False)
    accepted, request = await both.started()
    accepted.cancel()
    both.client.close()
    await eventually(lambda: both.provider.cancels == [request])


async def test_a_goal_whose_client_has_gone_may_end(robot: Robot) -> None:
    both = Both(robot, provides=True)
    _, request = await both.started()
    both.client.close()
    request.feedback(sequence(1))
    request.finish(SUCCEEDED, sequence(1))


async def test_closing_an_action_aborts_its_goals(robot: Robot) -> None:
    both = Both(robot, provides=True)
    accepted, request = await both.started()
    result = asyncio.ensure_future(accepted.result())
    other, its_request = await both.started()
    its_request.finish(SUCCEEDED, sequence())
    await soon(other.result())  # which was asked for after the first one's
    both.server.close()
    assert await soon(result) == (ABORTED, sequence())
    request.feedback(sequence(1))
    request.finish(SUCCEEDED, sequence(1))


async def test_closing_twice_is_harmless(robot: Robot) -> None:
    client = robot.ros.actions.action_client("/dock", FIBONACCI)
    server = robot.ros.actions.serve_action("/dock", FIBONACCI, ignore, ignore)
    assert robot.ros.diagnosis.entity_count() == 2
    for each in (client, server):
        each.close()
        each.close()
    assert robot.ros.diagnosis.entity_count() == 0


def attempts(robot: Robot, name: str, type_name: str) -> list[Callable[[], object]]:
    return [
        lambda: robot.ros.actions.action_client(name, type_name),
        lambda: robot.ros.actions.serve_action(name, type_name, ignore, ignore),
    ]


async def test_a_name_that_is_not_fully_qualified_is_bad(robot: Robot) -> None:
    found = {each: refusals(attempts(robot, each, FIBONACCI)) for each in BAD_NAMES}
    assert found == {key: {"bad_name"} for key in BAD_NAMES}
    assert robot.ros.diagnosis.entity_count() == 0


async def test_a_type_without_a_ros_package_is_bad(robot: Robot) -> None:
    found = {each: refusals(attempts(robot, "/dock", each)) for each in BAD_TYPES}
    assert found == {key: {"bad_type"} for key in BAD_TYPES}
    assert robot.ros.diagnosis.entity_count() == 0


async def test_an_action_is_provided_once(robot: Robot) -> None:
    server = robot.ros.actions.serve_action("/dock", FIBONACCI, ignore, ignore)
    with pytest.raises(RosError, match="action /dock is provided here already") as caught:
        robot.ros.actions.serve_action("/dock", FIBONACCI, ignore, ignore)
    assert caught.value.code == "limit_exceeded"
    server.close()
    robot.ros.actions.serve_action("/dock", FIBONACCI, ignore, ignore)


async def test_an_action_is_open_with_one_type_at_a_time(robot: Robot) -> None:
    client = robot.ros.actions.action_client("/dock", FIBONACCI)
    for attempt in attempts(robot, "/dock", NESTED):
        with pytest.raises(RosError, match=f"action /dock is open here as {FIBONACCI}") as caught:
            attempt()
        assert caught.value.code == "type_conflict"
    client.close()
    await eventually(lambda: opens(robot, NESTED))


def opens(robot: Robot, type_name: str) -> bool:
    """Try once: an executor that waits for a reader lets DDS destroy it a moment later."""
    try:
        robot.ros.actions.action_client("/dock", type_name)
    except RosError:
        return False
    return True


async def test_the_types_of_an_action_appear_and_vanish_with_it(robot: Robot) -> None:
    assert robot.ros.action_types("/dock") == ()
    outside = robot.world.add_action_server("/dock", FIBONACCI, ignore, ignore)
    await eventually(lambda: robot.ros.action_types("/dock") == (FIBONACCI,))
    outside.close()
    await eventually(lambda: robot.ros.action_types("/dock") == ())
    own = robot.ros.actions.serve_action("/dock", NESTED, ignore, ignore)
    await eventually(lambda: robot.ros.action_types("/dock") == (NESTED,))
    own.close()
    await eventually(lambda: robot.ros.action_types("/dock") == ())


async def test_the_graph_lists_actions_and_not_what_they_are_made_of(robot: Robot) -> None:
    robot.world.add_action_server("/dock", FIBONACCI, ignore, ignore)
    robot.ros.actions.serve_action("/own", NESTED, ignore, ignore)
    robot.ros.actions.action_client("/nobody", NESTED)

    def found() -> dict[str, tuple[tuple[str, ...], tuple[str, ...]]]:
        return {a.name: (a.types, a.nodes) for a in robot.ros.graph().actions}

    expected = {
        "/dock": ((FIBONACCI,), ("/outside",)),
        "/own": ((NESTED,), ("/ros2_gateway_services",)),
    }
    await eventually_equal(found, expected)
    graph = robot.ros.graph()
    names = [topic.name for topic in graph.topics] + [each.name for each in graph.services]
    assert not [name for name in names if "/_action/" in name]
