# SPDX-License-Identifier: Apache-2.0
"""Word of changes, by waiting."""

import asyncio
import concurrent.futures
import contextlib
import itertools
import threading
from collections.abc import Callable, Iterator

import pytest

from gateway.sources.rclpy.graph import GraphChanges, read_offers
from tests.client import TIMEOUT_S, eventually
from tests.sources.outside import Outside

INT32 = "std_msgs/msg/Int32"


@pytest.fixture
def watching() -> Iterator[Outside]:
    outside = Outside("watching")
    yield outside
    outside.close()


async def test_changes_are_told_on_the_loops_thread_until_closed(watching, outside):
    threads: list[int] = []
    changes = GraphChanges(
        watching.node,
        asyncio.get_running_loop(),
        lambda: threads.append(threading.get_ident()),
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
    changes = GraphChanges(watching.node, asyncio.get_running_loop(), lambda: None)
    assert threading.active_count() == before + 1
    changes.close()
    assert threading.active_count() == before


async def test_closing_between_two_looks_is_not_slept_through(watching, monkeypatch):
    waits = _WaitSetThatIsClosedWhileLooking()
    monkeypatch.setattr("gateway.sources.rclpy.graph.GraphWaitSet", lambda node: waits)
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
        stopping = self.stopping.result(TIMEOUT_S)
        if timeout_ns == 0:
            stopping.set()
        elif self._changes:
            self._changes -= 1
        else:
            self.slept_on = True
            stopping.set()


class _Settling(threading.Event):
    """Records how long the thread settles, and does not."""

    def __init__(self) -> None:
        super().__init__()
        self.settled_s: list[float] = []

    def wait(self, timeout: float | None = None) -> bool:
        self.settled_s.append(timeout or 0)
        return super().wait(0)


class _WaitSetOfChanges:
    """Wakes for a change each time the test lets it, or breaks."""

    def __init__(self) -> None:
        self.changes = threading.Semaphore(0)
        self.is_broken = False

    @contextlib.contextmanager
    def opened(self) -> Iterator[Callable[..., None]]:
        yield self._wait

    def wake(self) -> None:
        self.changes.release()

    def close(self) -> None: ...

    def _wait(self, timeout_ns: int = -1) -> None:
        if timeout_ns < 0:
            self.changes.acquire(timeout=TIMEOUT_S)
            if self.is_broken:
                raise RuntimeError("failed to wait on wait set")


@pytest.mark.parametrize(
    ("handling_s", "settle_s"),
    [(0.0, 0.02), (0.001, 0.02), (0.03125, 0.3125), (60.0, 1.0)],
)
async def test_following_the_graph_takes_at_most_a_tenth_of_the_loop(
    watching: Outside, monkeypatch: pytest.MonkeyPatch, handling_s: float, settle_s: float
) -> None:
    waits = _WaitSetOfChanges()
    clock = itertools.count(0.0, handling_s)
    monkeypatch.setattr("gateway.sources.rclpy.graph.GraphWaitSet", lambda node: waits)
    monkeypatch.setattr("gateway.sources.rclpy.graph.perf_counter", lambda: next(clock))
    calls: list[None] = []
    changes = GraphChanges(watching.node, asyncio.get_running_loop(), lambda: calls.append(None))
    changes._stopping = settling = _Settling()
    waits.changes.release()
    await eventually(lambda: len(calls) == 1)
    waits.changes.release()
    await eventually(lambda: len(calls) == 2)
    changes.close()
    assert settling.settled_s[:2] == [0.02, settle_s]


async def test_a_busy_loop_has_one_call_waiting(watching, monkeypatch):
    waits = _WaitSetOfChanges()
    monkeypatch.setattr("gateway.sources.rclpy.graph.GraphWaitSet", lambda node: waits)
    calls: list[None] = []
    changes = GraphChanges(watching.node, asyncio.get_running_loop(), lambda: calls.append(None))
    for _ in range(3):
        changes._report()
    await eventually(lambda: bool(calls))
    changes._report()
    await eventually(lambda: len(calls) > 1)
    assert len(calls) == 2
    changes.close()


async def test_a_wait_that_fails_is_logged_and_tried_again_a_second_later(
    watching: Outside, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    waits = _WaitSetOfChanges()
    waits.is_broken = True
    monkeypatch.setattr("gateway.sources.rclpy.graph.GraphWaitSet", lambda node: waits)
    calls: list[None] = []
    changes = GraphChanges(watching.node, asyncio.get_running_loop(), lambda: calls.append(None))
    changes._stopping = settling = _Settling()
    waits.changes.release()
    await eventually(lambda: bool(calls))  # it reports changes of this time
    assert settling.settled_s[0] == 1
    waits.is_broken = False
    calls.clear()
    waits.changes.release()
    await eventually(lambda: bool(calls))
    changes.close()
    assert [record.getMessage() for record in caplog.records] == [
        "waiting for graph changes failed, trying again in 1 s"
    ]
