# SPDX-License-Identifier: Apache-2.0
"""Goals of ours over rclpy: what the contract cannot see."""

import asyncio
from collections.abc import AsyncIterator
from typing import Any

import pytest
from rclpy.node import Node

from gateway.ports import ABORTED, SUCCEEDED, RosError
from gateway.ros import RosOptions, action_server
from gateway.ros.action_server import RclpyActionServer
from gateway.ros.port import RclpyRos
from tests.client import eventually
from tests.ros.outside import Outside
from tests.ros.test_contract_actions import (
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
    client = ros.action_client("/dock", FIBONACCI)
    for order in range(5):
        accepted = await soon(client.send_goal(goal(order), ignore))
        assert accepted is not None
        accepted.cancel()
        await eventually(lambda: len(provider.cancels) == len(provider.goals))
        provider.goals[-1].finish(ABORTED, sequence())
        await soon(accepted.result())
    assert await soon(client.send_goal(goal(100), ignore)) is None
    parts = (client._goals, client._results, client._cancels)
    await eventually(lambda: not any(part._under_way or part._waiting for part in parts))
    assert client._listening == {}


def accepts_small(cdr: bytes) -> bool:
    return cdr[4] < 100


async def test_goals_of_two_clients_do_not_mix(ros: RclpyRos, outside: Outside) -> None:
    provider = Provider()
    ros.serve_action("/dock", FIBONACCI, *provider.callbacks)
    heard: list[list[list[int]]] = [[], []]
    clients: list[Any] = [
        ros.action_client("/dock", FIBONACCI),
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


async def test_feedback_that_came_before_the_result_is_heard_before_it(ros: RclpyRos) -> None:
    provider = Provider()
    ros.serve_action("/dock", FIBONACCI, *provider.callbacks)
    client = ros.action_client("/dock", FIBONACCI)
    client._feedback._inlet._on_arrival = lambda: None  # type: ignore[attr-defined]  # it is slow
    heard: list[bytes] = []
    accepted = await soon(client.send_goal(goal(3), heard.append))
    provider.goals[-1].feedback(sequence(1))
    provider.goals[-1].finish(SUCCEEDED, sequence())
    await soon(accepted.result())
    assert [values_of(each) for each in heard] == [[1]]


async def test_a_goal_that_its_server_has_forgotten_has_no_result(
    ros: RclpyRos, monkeypatch: pytest.MonkeyPatch
) -> None:
    answer: Any = RclpyActionServer._answer_result

    def answer_late(server: Any, *request: Any) -> None:
        if server._goals:
            asyncio.get_running_loop().call_soon(answer_late, server, *request)
        else:
            answer(server, *request)

    monkeypatch.setattr(action_server, "RESULT_KEPT_S", 0.0)
    monkeypatch.setattr(RclpyActionServer, "_answer_result", answer_late)
    ros.serve_action("/dock", FIBONACCI, lambda each: each.finish(SUCCEEDED, sequence()), ignore)
    accepted = await soon(ros.action_client("/dock", FIBONACCI).send_goal(goal(3), ignore))
    with pytest.raises(RosError, match="action /dock has forgotten the goal") as caught:
        await soon(accepted.result())
    assert caught.value.code == "not_found"


async def test_a_goal_that_is_accepted_too_late_is_cancelled(
    ros: RclpyRos, monkeypatch: pytest.MonkeyPatch
) -> None:
    accept: Any = RclpyActionServer._accept
    requests: list[tuple[Any, ...]] = []
    monkeypatch.setattr(RclpyActionServer, "_accept", lambda *request: requests.append(request))
    provider = Provider()
    ros.serve_action("/dock", FIBONACCI, *provider.callbacks)
    client = ros.action_client("/dock", FIBONACCI)
    sending = asyncio.ensure_future(client.send_goal(goal(3), ignore))
    await eventually(lambda: len(requests) == 1)
    sending.cancel()
    await eventually(sending.cancelled)
    accept(*requests[0])
    await eventually(lambda: provider.cancels == provider.goals != [])
    assert client._listening == {}


async def test_an_action_of_which_a_part_is_refused_leaves_nothing(
    ros: RclpyRos, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise RuntimeError("no publishers today")

    node: Node = ros._services._endpoints.node
    before = entities_of(node)
    with monkeypatch.context() as patch:
        patch.setattr(node, "create_service", refuse)
        with pytest.raises(RosError, match="action /dock: no publishers today"):
            ros.serve_action("/dock", FIBONACCI, ignore, ignore)
        patch.setattr(ros._subscriptions._samples, "read", refuse)
        with pytest.raises(RosError, match="action /dock: no publishers today"):
            ros.action_client("/dock", FIBONACCI)
    assert entities_of(node) == before
    assert ros.entity_count() == 0


def entities_of(node: Node) -> list[int]:
    kinds = (node.clients, node.services, node.publishers, node.subscriptions)
    return [len(list(kind)) for kind in kinds]
