# SPDX-License-Identifier: Apache-2.0
"""An action of ours as a client of the specification sees it, part by part."""

import asyncio
from collections.abc import AsyncIterator
from typing import Any

import pytest
from rclpy.qos import qos_profile_action_status_default

from gateway.sources import action_server as limits
from gateway.sources.actions import ABORTED, CANCELED, SUCCEEDED, GoalRequest
from gateway.sources.rclpy import RosOptions
from gateway.sources.rclpy.interfaces import action_class, message_class, service_class
from gateway.sources.rclpy.port import RclpyRos
from tests.client import eventually
from tests.sources.conftest import known_to
from tests.sources.outside import Outside
from tests.sources.outside_services import arrived
from tests.sources.test_contract_actions import FIBONACCI, Provider, sequence, soon

ACTION: Any = action_class(FIBONACCI)
CANCEL: Any = service_class("action_msgs/srv/CancelGoal")
NO_ID = bytes(16)
S = 10**9


class Clock:
    """ROS time as the test sets it."""

    now_ns = 100 * S


class Caller:
    """Sends the requests that an action client is made of."""

    def __init__(self, outside: Outside, ros: RclpyRos) -> None:
        self._ros = ros
        self.provider = Provider()
        self.clock = Clock()
        ros.actions._now_ns = lambda: self.clock.now_ns
        self.server = ros.actions.serve_action("/dock", FIBONACCI, *self.provider.callbacks)
        self.statuses: list[dict[bytes, int]] = []
        self._loop = asyncio.get_running_loop()
        create = outside.node.create_client
        self._send: Any = create(ACTION.Impl.SendGoalService, "/dock/_action/send_goal")
        self._cancel: Any = create(CANCEL, "/dock/_action/cancel_goal")
        self._result: Any = create(ACTION.Impl.GetResultService, "/dock/_action/get_result")
        outside.node.create_subscription(
            message_class("action_msgs/msg/GoalStatusArray"),
            "/dock/_action/status",
            self._hear,
            qos_profile_action_status_default,
        )

    async def send(self, goal_id: bytes, order: int = 3) -> Any:
        request = ACTION.Impl.SendGoalService.Request()
        request.goal_id.uuid = list(goal_id)
        request.goal.order = order
        return await self._call(self._send, request)

    async def cancel(self, goal_id: bytes = NO_ID, until_ns: int = 0) -> tuple[int, list[bytes]]:
        request = CANCEL.Request()
        request.goal_info.goal_id.uuid = list(goal_id)
        request.goal_info.stamp.sec, request.goal_info.stamp.nanosec = divmod(until_ns, S)
        response = await self._call(self._cancel, request)
        ids = [bytes(info.goal_id.uuid) for info in response.goals_canceling]
        return response.return_code, ids

    async def result(self, goal_id: bytes) -> tuple[int, list[int]]:
        request = ACTION.Impl.GetResultService.Request()
        request.goal_id.uuid = list(goal_id)
        response = await self._call(self._result, request)
        return response.status, list(response.result.sequence)

    async def _call(self, client: Any, request: Any) -> Any:
        await eventually(client.service_is_ready)
        await eventually(lambda: known_to(self._ros, client.srv_name))
        return await soon(arrived(client.call_async(request)))

    def _hear(self, message: Any) -> None:
        statuses = {bytes(each.goal_info.goal_id.uuid): each.status for each in message.status_list}
        self._loop.call_soon_threadsafe(self.statuses.append, statuses)


@pytest.fixture
async def ros() -> AsyncIterator[RclpyRos]:
    ros = RclpyRos(RosOptions())
    yield ros
    ros.close()


@pytest.fixture
async def caller(ros: RclpyRos, outside: Outside) -> Caller:
    return Caller(outside, ros)


def goal_id(number: int) -> bytes:
    return number.to_bytes(16, "little")


async def started(caller: Caller, *numbers: int) -> list[GoalRequest]:
    """Send goals, a second of ROS time apart."""
    for number in numbers:
        assert (await caller.send(goal_id(number))).accepted
        caller.clock.now_ns += S
    return caller.provider.goals[-len(numbers) :]


async def test_an_accepted_goal_gets_the_ros_time_of_its_acceptance(caller: Caller) -> None:
    caller.clock.now_ns = 7 * S + 5
    response = await caller.send(goal_id(1))
    assert (response.accepted, response.stamp.sec, response.stamp.nanosec) == (True, 7, 5)


async def test_a_goal_id_is_accepted_once(caller: Caller) -> None:
    await started(caller, 1)
    assert not (await caller.send(goal_id(1))).accepted
    assert len(caller.provider.goals) == 1


async def test_goals_beyond_the_limit_are_rejected_until_one_ends(caller: Caller) -> None:
    [first, *_] = await started(caller, *range(64))
    assert not (await caller.send(goal_id(64))).accepted
    first.finish(SUCCEEDED, sequence())
    assert (await caller.send(goal_id(65))).accepted


async def test_the_result_of_an_unknown_goal_is_unknown(caller: Caller) -> None:
    assert await caller.result(goal_id(9)) == (0, [])


async def test_a_result_is_kept_for_15_minutes(caller: Caller) -> None:
    [goal] = await started(caller, 1)
    loop = asyncio.get_running_loop()
    before = loop.time()
    goal.finish(SUCCEEDED, sequence(4))
    assert before + 900 <= goal.expiry.when() <= loop.time() + 900


async def test_a_result_is_forgotten_after_a_time(caller, monkeypatch):
    monkeypatch.setattr(limits, "RESULT_KEPT_S", 0.0)
    [goal] = await started(caller, 1)
    goal.finish(SUCCEEDED, sequence(4))
    await eventually(lambda: not caller.server._goals)
    assert await caller.result(goal_id(1)) == (0, [])


async def test_the_oldest_results_make_room_for_new_ones(caller: Caller) -> None:
    for number in range(65):
        [goal] = await started(caller, number)
        goal.finish(SUCCEEDED, sequence(4))
    statuses = [(await caller.result(goal_id(number)))[0] for number in (0, 1, 64)]
    assert statuses == [0, SUCCEEDED, SUCCEEDED]


async def test_a_request_that_is_too_late_to_wait_takes_no_place(caller, monkeypatch):
    monkeypatch.setattr(limits, "MAX_WAITING", 2)
    [goal] = await started(caller, 1)
    first = [asyncio.ensure_future(caller.result(goal_id(1))) for _ in range(2)]
    entry = caller.server._goals[goal_id(1)]
    await eventually(lambda: len(entry.waiting) == 2)
    assert (await caller.result(goal_id(1)))[0] == 0  # unknown
    goal.finish(SUCCEEDED, sequence(4))
    assert [await each for each in first] == [(SUCCEEDED, [4])] * 2


async def test_sixteen_may_wait_for_the_result_of_one_goal(caller: Caller) -> None:
    [goal] = await started(caller, 1)
    for _ in range(20):
        caller.server._answer_result(
            ACTION.Impl.GetResultService.Request(goal_id=uuid_of(1)),
            lambda response: None,
        )
    assert len(goal.waiting) == 16


async def test_every_change_of_a_status_is_published(caller: Caller) -> None:
    [first, _] = await started(caller, 1, 2)
    await eventually(lambda: caller.statuses[-1:] == [{goal_id(1): 2, goal_id(2): 2}])
    await caller.cancel(goal_id(1))
    await eventually(lambda: caller.statuses[-1] == {goal_id(1): 3, goal_id(2): 2})
    first.finish(CANCELED, sequence())
    await eventually(lambda: caller.statuses[-1] == {goal_id(1): 5, goal_id(2): 2})
    caller.server.close()
    await eventually(lambda: caller.statuses[-1] == {goal_id(1): 5, goal_id(2): 6})


@pytest.mark.parametrize(
    ("goal", "until_s", "code", "canceled"),
    [
        (NO_ID, 0, 0, [1, 2, 3]),  # without id and stamp: all of them
        (NO_ID, 101, 0, [1, 2]),
        (goal_id(3), 100, 0, [1, 3]),
        (goal_id(9), 0, 2, []),  # which nobody has sent
    ],
)
async def test_goals_are_canceled_by_id_and_by_the_time_of_their_acceptance(
    caller, goal, until_s, code, canceled
):
    goals = await started(caller, 1, 2, 3)
    assert await caller.cancel(goal, until_s * S) == (code, list(map(goal_id, canceled)))
    assert caller.provider.cancels == [goals[number - 1] for number in canceled]


async def test_a_goal_that_has_ended_cannot_be_canceled(caller: Caller) -> None:
    [goal] = await started(caller, 1)
    goal.finish(SUCCEEDED, sequence())
    assert await caller.cancel(goal_id(1)) == (3, [])
    assert await caller.cancel() == (0, [])
    assert caller.provider.cancels == []


async def test_a_goal_that_is_being_canceled_cannot_be_canceled_again(caller: Caller) -> None:
    [goal] = await started(caller, 1)
    assert await caller.cancel(goal_id(1)) == (0, [goal_id(1)])
    assert await caller.cancel(goal_id(1)) == (3, [])  # as rcl_action has it
    assert caller.provider.cancels == [goal]


async def test_a_goal_that_ends_with_another_is_not_reported_as_canceled(caller: Caller) -> None:
    goals: list[GoalRequest] = []

    def end_all(_: GoalRequest) -> None:
        for goal in goals:
            goal.finish(CANCELED, sequence())
        caller.provider.cancels.append(goals[0])

    goals += await started(caller, 1, 2)
    caller.server._on_cancel = end_all
    await caller.cancel()
    assert caller.provider.cancels == goals[:1]
    assert (await caller.result(goal_id(2)))[0] == CANCELED


async def test_an_action_that_closes_answers_what_has_arrived(caller: Caller) -> None:
    await started(caller, 1)
    sends: list[Any] = [
        caller._send.call_async(ACTION.Impl.SendGoalService.Request(goal_id=uuid_of(2))),
        caller._result.call_async(ACTION.Impl.GetResultService.Request(goal_id=uuid_of(1))),
        caller._cancel.call_async(CANCEL.Request()),
    ]
    caller.server.close()  # in the same turn: none of them has been taken
    goal, result, cancel = [await soon(arrived(each)) for each in sends]
    assert not goal.accepted
    assert result.status == ABORTED
    assert cancel.goals_canceling == []
    assert len(caller.provider.goals) == 1


def uuid_of(number: int) -> Any:
    return message_class("unique_identifier_msgs/msg/UUID")(uuid=list(goal_id(number)))


async def test_an_action_that_closes_leaves_no_timer_for_its_results(caller: Caller) -> None:
    [goal, _] = await started(caller, 1, 2)
    goal.finish(SUCCEEDED, sequence())
    entries = list(caller.server._goals.values())
    caller.server.close()
    timers = [each.expiry for each in entries if each.expiry is not None]
    assert len(timers) == 2
    await eventually(lambda: all(timer.cancelled() for timer in timers))
