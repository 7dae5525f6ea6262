# SPDX-License-Identifier: Apache-2.0
"""Goals of ours over rclpy: what the contract cannot see."""

import asyncio
from collections.abc import AsyncIterator
from typing import Any

import pytest
from rclpy.node import Node

from gateway.sources import action_client, action_server, requester
from gateway.sources.actions import ABORTED, SUCCEEDED
from gateway.sources.rclpy import RosOptions
from gateway.sources.rclpy.action_client import RclpyActionClient
from gateway.sources.rclpy.action_server import RclpyActionServer
from gateway.sources.rclpy.interfaces import action_class
from gateway.sources.rclpy.port import RclpyRos
from gateway.sources.rclpy.requester import RclpyRequester
from gateway.sources.source import RosError
from tests.client import eventually
from tests.sources.outside import Outside
from tests.sources.test_contract_actions import (
    FIBONACCI,
    Provider,
    goal,
    ignore,
    sequence,
    soon,
    values_of,
)


@pytest.fixture
async def ros() -> AsyncIterator[RclpyRos]:
    ros = RclpyRos(RosOptions())
    yield ros
    ros.close()


async def test_goals_that_have_ended_leave_nothing_behind(ros: RclpyRos, outside: Outside) -> None:
    provider = Provider()
    outside.add_action_server("/dock", FIBONACCI, *provider.callbacks, accepts=accepts_small)
    client = ros.actions.action_client("/dock", FIBONACCI)
    for order in range(5):
        accepted = await soon(client.send_goal(goal(order), ignore))
        accepted.cancel()
        await eventually(lambda: len(provider.cancels) == order + 1)  # noqa: B023
        provider.goals[-1].finish(ABORTED, sequence())
        await soon(accepted.result())
    assert await soon(client.send_goal(goal(100), ignore)) is None
    parts = (client._goals, client._results, client._cancels)
    await eventually(lambda: not any(part._under_way or part._waiting for part in parts))
    assert client._feedback_callbacks == {}


def accepts_small(cdr: bytes) -> bool:
    return cdr[4] < 100


async def test_goals_of_two_clients_do_not_mix(ros: RclpyRos, outside: Outside) -> None:
    provider = Provider()
    ros.actions.serve_action("/dock", FIBONACCI, *provider.callbacks)
    heard: list[list[list[int]]] = [[], []]
    clients: list[Any] = [
        ros.actions.action_client("/dock", FIBONACCI),
        outside.add_action_client("/dock", FIBONACCI),
    ]
    accepted = [
        await soon(client.send_goal(goal(order), lambda cdr, own=own: own.append(values_of(cdr))))
        for order, (client, own) in enumerate(zip(clients, heard, strict=True))
    ]
    for order, request in enumerate(provider.goals):
        request.feedback(sequence(order))
        request.finish(SUCCEEDED, sequence(order))
    assert [values_of((await soon(each.result())).cdr) for each in accepted] == [[0], [1]]
    await eventually(lambda: heard == [[[0]], [[1]]])


async def test_a_goal_outlives_a_moment_in_which_its_action_is_unready(ros, outside, monkeypatch):
    provider = Provider()

    def accept(_: bytes) -> bool:  # rmw has found half of another server
        monkeypatch.setattr(RclpyRequester, "is_ready", False)
        return True

    outside.add_action_server("/dock", FIBONACCI, *provider.callbacks, accepts=accept)
    accepted = await soon(ros.actions.action_client("/dock", FIBONACCI).send_goal(goal(3), ignore))
    accepted.cancel()
    await eventually(lambda: len(provider.cancels) == 1)
    provider.goals[-1].finish(SUCCEEDED, sequence(3))
    assert values_of((await soon(accepted.result())).cdr) == [3]


async def test_feedback_that_came_before_the_result_is_heard_before_it(ros: RclpyRos) -> None:
    provider = Provider()
    ros.actions.serve_action("/dock", FIBONACCI, *provider.callbacks)
    client = ros.actions.action_client("/dock", FIBONACCI)
    asyncio.get_running_loop().remove_reader(client._feedback._source._fd)  # it is slow
    heard: list[bytes] = []
    accepted = await soon(client.send_goal(goal(3), heard.append))
    provider.goals[-1].feedback(sequence(1))
    provider.goals[-1].finish(SUCCEEDED, sequence())
    await soon(accepted.result())
    assert [values_of(each) for each in heard] == [[1]]


async def test_a_goal_that_its_server_has_forgotten_has_no_result(ros, monkeypatch):
    answer: Any = RclpyActionServer._answer_result

    def answer_late(server: Any, *request: Any) -> None:
        if server._goals:
            asyncio.get_running_loop().call_soon(answer_late, server, *request)
        else:
            answer(server, *request)

    monkeypatch.setattr(action_server, "RESULT_KEPT_S", 0.0)
    monkeypatch.setattr(RclpyActionServer, "_answer_result", answer_late)
    ros.actions.serve_action(
        "/dock", FIBONACCI, lambda each: each.finish(SUCCEEDED, sequence()), ignore
    )
    accepted = await soon(ros.actions.action_client("/dock", FIBONACCI).send_goal(goal(3), ignore))
    with pytest.raises(RosError, match="action /dock does not know the goal") as caught:
        await soon(accepted.result())
    assert caught.value.code == "not_found"


class Slow:
    """An action ``/dock`` of the gateway's that leaves it to the test when goals are accepted."""

    def __init__(self, ros: RclpyRos, monkeypatch: pytest.MonkeyPatch) -> None:
        self.requests: list[tuple[Any, ...]] = []
        self.provider = Provider()
        self._accept: Any = RclpyActionServer._accept
        monkeypatch.setattr(
            RclpyActionServer, "_accept", lambda *request: self.requests.append(request)
        )
        self.server = ros.actions.serve_action("/dock", FIBONACCI, *self.provider.callbacks)

    async def gets_goal_that_is_given_up(self, client: RclpyActionClient) -> None:
        count = len(self.requests)
        sending = asyncio.ensure_future(client.send_goal(goal(3), ignore))
        await eventually(lambda: len(self.requests) > count)
        sending.cancel()
        await eventually(sending.cancelled)

    def accept(self, index: int) -> None:
        self._accept(*self.requests[index])


@pytest.fixture
def slow(ros: RclpyRos, monkeypatch: pytest.MonkeyPatch) -> Slow:
    return Slow(ros, monkeypatch)


async def test_a_goal_that_is_accepted_too_late_is_cancelled(ros: RclpyRos, slow: Slow) -> None:
    client = ros.actions.action_client("/dock", FIBONACCI)
    await slow.gets_goal_that_is_given_up(client)
    slow.accept(0)
    await eventually(lambda: slow.provider.cancels == slow.provider.goals != [])
    await eventually(lambda: not client._abandoned)
    assert client._feedback_callbacks == {}
    assert ros.entity_count() == 2


async def test_a_closed_client_stays_until_goals_that_were_given_up_are_decided(ros, slow):
    client = ros.actions.action_client("/dock", FIBONACCI)
    for _ in range(2):
        await slow.gets_goal_that_is_given_up(client)
    client.close()
    for index in range(2):
        assert ros.entity_count() == 2
        slow.accept(index)
        await eventually(lambda: slow.provider.cancels == slow.provider.goals != [])
    await eventually(lambda: ros.entity_count() == 1)
    assert len(slow.provider.cancels) == 2


async def test_other_requests_of_a_client_fail_when_it_closes_though_it_stays(ros, slow):
    client = ros.actions.action_client("/dock", FIBONACCI)
    heard: list[bytes] = []
    sending = asyncio.ensure_future(client.send_goal(goal(3), heard.append))
    await eventually(lambda: len(slow.requests) == 1)
    slow.accept(0)
    accepted = await soon(sending)
    await slow.gets_goal_that_is_given_up(client)
    undecided = asyncio.ensure_future(client.send_goal(goal(3), ignore))
    await eventually(lambda: len(slow.requests) == 3)
    slow.provider.goals[0].feedback(sequence(1))
    client.close()
    assert ros.entity_count() == 2
    for failing in (accepted.result(), undecided, client.send_goal(goal(3), ignore)):
        with pytest.raises(RosError, match="client of action /dock is closed"):
            await soon(failing)
    slow.accept(1)
    await eventually(lambda: ros.entity_count() == 1)
    assert slow.provider.cancels == slow.provider.goals[1:]
    assert heard == []


async def test_a_closed_client_waits_for_a_decision_for_30_s(ros: RclpyRos, slow: Slow) -> None:
    client = ros.actions.action_client("/dock", FIBONACCI)
    await slow.gets_goal_that_is_given_up(client)
    loop = asyncio.get_running_loop()
    before = loop.time()
    client.close()
    assert before + 30 <= client._destroy_timer.when() <= loop.time() + 30


async def test_a_closed_client_waits_for_a_decision_only_so_long(ros, slow, monkeypatch):
    monkeypatch.setattr(action_client, "_ABANDONED_S", 0.01)
    client = ros.actions.action_client("/dock", FIBONACCI)
    await slow.gets_goal_that_is_given_up(client)
    client.close()
    await eventually(lambda: ros.entity_count() == 1)


async def test_a_closed_client_does_not_wait_for_a_server_that_has_gone(ros, slow):
    client = ros.actions.action_client("/dock", FIBONACCI)
    await slow.gets_goal_that_is_given_up(client)
    client.close()
    slow.server.close()
    await eventually(lambda: ros.entity_count() == 0)


async def test_closing_the_port_waits_for_no_decision(ros: RclpyRos, slow: Slow) -> None:
    clients = [ros.actions.action_client("/dock", FIBONACCI) for _ in range(2)]
    for client in clients:
        await slow.gets_goal_that_is_given_up(client)
    clients[0].close()
    ros.close()
    assert ros.entity_count() == 0


async def test_a_goal_that_is_given_up_while_it_waits_is_never_sent(ros: RclpyRos) -> None:
    client = ros.actions.action_client("/dock", FIBONACCI)
    sending = asyncio.ensure_future(client.send_goal(goal(3), ignore))
    await asyncio.sleep(0)
    sending.cancel()
    await eventually(sending.cancelled)
    provider = Provider()
    ros.actions.serve_action("/dock", FIBONACCI, *provider.callbacks)
    assert await soon(client.send_goal(goal(4), ignore)) is not None
    assert [each.cdr for each in provider.goals] == [goal(4)]


async def test_a_goal_waits_until_its_feedback_can_be_heard(ros, outside):
    parts: Any = action_class(FIBONACCI).Impl
    goals: list[Any] = []

    def accept(request: Any, answer: Any) -> Any:
        goals.append(request)
        answer.accepted = True
        return answer

    services: list[tuple[Any, str, Any]] = [
        (parts.SendGoalService, "send_goal", accept),
        (parts.GetResultService, "get_result", lambda _, answer: answer),
        (parts.CancelGoalService, "cancel_goal", lambda _, answer: answer),
    ]
    for part_class, part, answer in services:
        outside.node.create_service(part_class, f"/dock/_action/{part}", answer)
    client = ros.actions.action_client("/dock", FIBONACCI)
    sending = asyncio.ensure_future(client.send_goal(goal(3), ignore))
    for each in (client._goals, client._results, client._cancels):
        await eventually(each._client.service_is_ready)
    client.follow_graph()
    assert not client._goals.is_ready
    assert goals == []
    outside.node.create_publisher(parts.FeedbackMessage, "/dock/_action/feedback", 10)
    assert await soon(sending) is not None
    assert len(goals) == 1


async def test_an_action_of_which_a_part_is_refused_leaves_nothing(ros, monkeypatch):
    def refuse(*_: object, **__: object) -> None:
        raise RuntimeError("not today")

    node: Node = ros.services._endpoints.node
    hearing: Node = ros._subscriptions._samples.node
    before = entities_of(node, hearing)
    with monkeypatch.context() as patch:
        patch.setattr(node, "create_service", refuse)
        with pytest.raises(RosError, match="action /dock: not today"):
            ros.actions.serve_action("/dock", FIBONACCI, ignore, ignore)
        patch.setattr(node, "create_client", refuse)
        with pytest.raises(RosError, match="action /dock: not today"):
            ros.actions.action_client("/dock", FIBONACCI)
    assert entities_of(node, hearing) == before
    assert ros.entity_count() == 0


def entities_of(*nodes: Node) -> list[int]:
    kinds = [(n.clients, n.services, n.publishers, n.subscriptions) for n in nodes]
    return [len(list(each)) for kind in kinds for each in kind]


async def accepted_goals(client: RclpyActionClient, provider: Provider, count: int) -> list[Any]:
    goals = [await soon(client.send_goal(goal(order), ignore)) for order in range(count)]
    await eventually(lambda: len(provider.goals) == count)
    return goals


async def test_a_client_that_closes_stays_until_all_its_cancels_are_answered(
    ros: RclpyRos, outside: Outside, monkeypatch: pytest.MonkeyPatch
) -> None:
    provider = Provider()
    outside.add_action_server("/dock", FIBONACCI, *provider.callbacks)
    client = ros.actions.action_client("/dock", FIBONACCI)
    goals = await accepted_goals(client, provider, 16)
    monkeypatch.setattr(requester, "PACING_S", 1e6)
    for accepted in goals:
        accepted.cancel()
    client.close()
    assert ros.entity_count() == 1
    await eventually(lambda: len(provider.cancels) == 16)
    await eventually(lambda: ros.entity_count() == 0)


async def test_closing_the_port_sends_all_cancels(ros: RclpyRos) -> None:
    provider = Provider()
    ros.actions.serve_action("/dock", FIBONACCI, *provider.callbacks)
    closing = RclpyRos(RosOptions(node_prefix="closing"))
    client = closing.actions.action_client("/dock", FIBONACCI)
    goals = await accepted_goals(client, provider, 16)
    for accepted in goals:
        accepted.cancel()
    client.close()
    closing.close()
    await eventually(lambda: len(provider.cancels) == 16)


async def test_a_closed_client_waits_for_the_answer_to_a_cancel_only_so_long(ros, monkeypatch):
    monkeypatch.setattr(action_client, "_ABANDONED_S", 0.01)
    monkeypatch.setattr(RclpyActionServer, "_cancel", ignore)
    provider = Provider()
    ros.actions.serve_action("/dock", FIBONACCI, *provider.callbacks)
    client = ros.actions.action_client("/dock", FIBONACCI)
    [accepted] = await accepted_goals(client, provider, 1)
    accepted.cancel()
    client.close()
    await eventually(lambda: ros.entity_count() == 1)


async def test_a_goal_that_has_ended_waits_for_no_answer_to_its_cancel(ros, monkeypatch):
    monkeypatch.setattr(RclpyActionServer, "_cancel", ignore)
    provider = Provider()
    ros.actions.serve_action("/dock", FIBONACCI, *provider.callbacks)
    client = ros.actions.action_client("/dock", FIBONACCI)
    [accepted] = await accepted_goals(client, provider, 1)
    accepted.cancel()
    await eventually(lambda: bool(client._cancels._under_way))
    provider.goals[0].finish(SUCCEEDED, sequence())
    await soon(accepted.result())
    await eventually(lambda: not client._cancels._under_way)
    client.close()
    assert ros.entity_count() == 1


async def test_the_last_of_many_goals_may_end_first(ros, outside, monkeypatch):
    monkeypatch.setattr(requester, "PACING_S", 1e6)
    provider = Provider()
    outside.add_action_server("/dock", FIBONACCI, *provider.callbacks)
    client = ros.actions.action_client("/dock", FIBONACCI)
    goals = await accepted_goals(client, provider, 16)
    provider.goals[-1].finish(SUCCEEDED, sequence(1))
    assert await soon(goals[-1].result()) == (SUCCEEDED, sequence(1))


async def test_a_burst_of_feedback_is_heard(ros: RclpyRos) -> None:
    heard: list[bytes] = []
    provider = Provider()
    ros.actions.serve_action("/dock", FIBONACCI, *provider.callbacks)
    client = ros.actions.action_client("/dock", FIBONACCI)
    await soon(client.send_goal(goal(3), heard.append))
    await eventually(lambda: bool(provider.goals))
    for value in range(50):
        provider.goals[0].feedback(sequence(value))
    await eventually(lambda: [values_of(each) for each in heard] == [[v] for v in range(50)])


async def test_a_server_knows_of_the_feedbacks_reader_before_it_can_accept(ros: RclpyRos) -> None:
    samples = ros._subscriptions._samples
    read, clients = samples.read, []

    def read_first(*arguments: Any) -> Any:
        clients.append(len(list(ros.services._endpoints.node.clients)))
        return read(*arguments)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(samples, "read", read_first)
        ros.actions.action_client("/dock", FIBONACCI)
    assert clients == [0]
