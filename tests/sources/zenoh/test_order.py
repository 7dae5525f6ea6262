# SPDX-License-Identifier: Apache-2.0
"""The threads by which answers and feedback come, and their order."""

import asyncio
import threading
import time
from collections.abc import Callable
from typing import Any

import pytest

from gateway.sources.actions import SUCCEEDED, GoalRequest
from gateway.sources.requester import MAX_IN_FLIGHT
from gateway.sources.services import ServiceRequest
from tests.client import eventually
from tests.sources.test_contract_actions import FIBONACCI, goal, ignore, sequence, soon, values_of
from tests.sources.test_contract_services import SET_BOOL, echo, request
from tests.sources.zenoh.conftest import open_robot


def late(call: Callable[..., None]) -> Callable[..., None]:
    """Delay what a thread of Zenoh calls, as a busy machine does."""

    def call_later(*args: Any) -> None:
        time.sleep(0.03)
        call(*args)

    return call_later


async def test_feedback_from_before_a_result_comes_before_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with open_robot() as (source, robot):
        monkeypatch.setattr(source.inbox, "put", late(source.inbox.put))
        goals: list[GoalRequest] = []
        robot.add_action_server("/fib", FIBONACCI, goals.append, ignore)
        client = source.actions.action_client("/fib", FIBONACCI)
        heard: list[bytes] = []
        accepted = await soon(client.send_goal(goal(3), heard.append))
        await eventually(lambda: bool(goals and goals[0].waiting))
        for number in range(5):
            goals[0].feedback(sequence(number))
        goals[0].finish(SUCCEEDED, sequence(1))
        await soon(accepted.result())
        assert [values_of(each) for each in heard] == [[0], [1], [2], [3], [4]]


async def test_requests_that_wait_for_answers_have_no_threads() -> None:
    with open_robot() as (source, robot):
        requests: list[ServiceRequest] = []
        robot.add_service("/arm", SET_BOOL, requests.append)
        client = source.services.client("/arm", SET_BOOL)
        before = threading.active_count()
        calls = [asyncio.ensure_future(client.call(request(True))) for _ in range(MAX_IN_FLIGHT)]
        await eventually(lambda: len(requests) == len(calls))
        assert threading.active_count() == before
        for each in requests:
            echo(each)
        await soon(asyncio.gather(*calls))
