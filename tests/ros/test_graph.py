# SPDX-License-Identifier: Apache-2.0
"""Word of changes, by waiting and by looking."""

import asyncio
import concurrent.futures
import contextlib
import threading
from collections.abc import Callable, Iterator

import pytest

from gateway.ports import Qos
from gateway.ros import RosOptions
from gateway.ros.graph import GraphChanges, read_offers
from gateway.ros.port import RclpyRos
from tests.client import eventually
from tests.ros.outside import Outside

INT32 = "std_msgs/msg/Int32"


@pytest.fixture
def watching() -> Iterator[Outside]:
    outside = Outside("watching")
    yield outside
    outside.close()


@pytest.mark.parametrize("polling", [False, True])
async def test_changes_are_told_on_the_loops_thread_until_closed(
    watching: Outside, outside: Outside, polling: bool
) -> None:
    threads: list[int] = []
    changes = GraphChanges(
        watching.node,
        asyncio.get_running_loop(),
        lambda: threads.append(threading.get_ident()),
        polling=polling,
    )
    publisher = outside.add_publisher("/count", INT32)
    await eventually(lambda: bool(threads) and bool(read_offers(watching.node, "/count")))
    threads.clear()
    publisher.close()
    await eventually(lambda: bool(threads))
    assert set(threads) == {threading.get_ident()}
    changes.close()
    threads.clear()
    outside.add_publisher("/count", INT32)
    await eventually(lambda: bool(read_offers(watching.node, "/count")))
    assert threads == []


async def test_closing_ends_the_thread_at_once(watching: Outside) -> None:
    before = threading.active_count()
    for polling in (False, True):
        changes = GraphChanges(
            watching.node, asyncio.get_running_loop(), lambda: None, polling=polling
        )
        assert threading.active_count() == before + 1
        changes.close()
        assert threading.active_count() == before


async def test_a_subscription_follows_its_publishers_where_nobody_can_wait(
    outside: Outside, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("gateway.ros.graph._GraphWaitSet.create", lambda node: None)
    ros = RclpyRos(RosOptions())
    try:
        subscription = ros.subscribe("/count", INT32, Qos(), lambda _: None, lambda _: None)
        outside.add_publisher("/count", INT32, Qos(reliability="best_effort"))
        await eventually(lambda: subscription.qos.reliability == "best_effort")
    finally:
        ros.close()


async def test_closing_between_two_looks_is_not_slept_through(
    watching: Outside, monkeypatch: pytest.MonkeyPatch
) -> None:
    waits = _WaitSetThatIsClosedWhileLooking()
    monkeypatch.setattr("gateway.ros.graph._GraphWaitSet.create", lambda node: waits)
    changes = GraphChanges(watching.node, asyncio.get_running_loop(), lambda: None)
    waits.stopping.set_result(changes._stopping)
    await asyncio.to_thread(changes._thread.join, 30)
    assert not waits.slept_on
    assert not changes._thread.is_alive()


class _WaitSetThatIsClosedWhileLooking:
    """Wakes for a change, and is woken by `close` just when it looks for more."""

    def __init__(self) -> None:
        self.stopping: concurrent.futures.Future[threading.Event] = concurrent.futures.Future()
        self.slept_on = False
        self._changes = 1

    @contextlib.contextmanager
    def opened(self) -> Iterator[Callable[..., None]]:
        yield self._wait

    def _wait(self, timeout_ns: int = -1) -> None:
        stopping = self.stopping.result(30)
        if timeout_ns == 0:
            stopping.set()
        elif self._changes:
            self._changes -= 1
        else:
            self.slept_on = True
            stopping.set()
