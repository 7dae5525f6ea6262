# SPDX-License-Identifier: Apache-2.0
"""A thread that waits for all entities: what the contract cannot see."""

import asyncio
import threading
import time
from collections.abc import AsyncIterator, Iterator, Sequence
from typing import Any

import pytest
from rclpy.context import Context
from rclpy.node import Node
from std_msgs.msg import Int32
from std_srvs.srv import SetBool

from gateway.sources.rclpy import rclpy_private, wait_set_events
from gateway.sources.rclpy.rclpy_private import EntityWaitSet
from gateway.sources.rclpy.wait_set_events import WaitSetReadyEvents
from tests.client import eventually
from tests.clock import StoppedClock
from tests.sources.nodes import open_node


class Counting(EntityWaitSet):
    """Counts how often it has begun to wait."""

    waits = 0

    def wait(self, entities: Sequence[tuple[Any, Any]]) -> Sequence[int]:
        self.waits += 1
        return super().wait(entities)


@pytest.fixture
def node() -> Iterator[Node]:
    context = Context()
    context.init(args=["--ros-args", "--disable-stdout-logs"])
    node = open_node("waiting", context, start_parameter_services=False)
    yield node
    node.destroy_node()
    context.try_shutdown()
    context.destroy()


@pytest.fixture
async def events(node: Node, monkeypatch: pytest.MonkeyPatch) -> AsyncIterator[WaitSetReadyEvents]:
    monkeypatch.setattr(wait_set_events, "EntityWaitSet", Counting)
    events = WaitSetReadyEvents(node.context, asyncio.get_running_loop())
    yield events
    events.close()


class Subscription:
    """A subscription and the calls that say that it is ready. Takes nothing by itself."""

    def __init__(self, node: Node, events: WaitSetReadyEvents) -> None:
        self.calls = 0
        self.source = events.open(
            "subscription",
            lambda: node.create_subscription(Int32, "/count", print, 100),
            node.destroy_subscription,
            self._count,
        )
        self.publisher = node.create_publisher(Int32, "/count", 100)

    async def is_matched(self) -> None:
        await eventually(lambda: self.publisher.get_subscription_count() == 1)

    def take(self) -> None:
        while rclpy_private.message_taker(self.source.entity)(Int32, True) is not None:
            pass

    def _count(self) -> None:
        self.calls += 1
        self.on_ready()

    def on_ready(self) -> None:
        self.take()


async def test_a_ready_source_is_not_waited_for_until_it_is_taken(node, events):
    subscription = Subscription(node, events)
    await subscription.is_matched()

    def take_late() -> None:
        time.sleep(0.1)  # in which the thread would wait a thousand times
        subscription.take()

    subscription.on_ready = take_late  # type: ignore[method-assign]
    wait_set: Any = events._wait_set
    for number in range(1, 4):
        subscription.publisher.publish(Int32())
        await eventually(lambda: subscription.calls >= number)  # noqa: B023
    assert wait_set.waits <= 2 + 2 * 3
    subscription.source.close()


async def test_a_source_that_is_not_taken_is_reported_again(node, events):
    subscription = Subscription(node, events)
    await subscription.is_matched()
    subscription.on_ready = lambda: None  # type: ignore[method-assign]
    subscription.publisher.publish(Int32())
    await eventually(lambda: subscription.calls > 5)
    subscription.source.close()


async def test_another_call_comes_in_the_next_turn_and_is_not_waited_for(node, events):
    turns: list[int] = []

    def on_ready() -> None:
        turns.append(turn)
        if len(turns) < 100:
            source.notify_again()

    turn = 0
    source = events.open(
        "client",
        lambda: node.create_client(SetBool, "/nobody"),
        node.destroy_client,
        on_ready,
    )
    source.notify_again()
    while len(turns) < 100:
        turn += 1
        await asyncio.sleep(0)
    source.close()
    assert turns == sorted(set(turns))


async def test_a_handling_that_raises_is_tried_again_after_100_ms(node, events, monkeypatch):
    def fail() -> None:
        raise LookupError

    subscription = Subscription(node, events)
    subscription.on_ready = fail  # type: ignore[method-assign]
    clock = StoppedClock(monkeypatch)
    with pytest.raises(LookupError):
        subscription.source.notify()
    subscription.on_ready = subscription.take  # type: ignore[method-assign]
    await clock.advance(0.09)
    assert subscription.calls == 1
    await clock.advance(0.02)
    assert subscription.calls == 2
    subscription.source.close()


async def test_nothing_is_told_of_what_is_closed(node: Node, events: WaitSetReadyEvents) -> None:
    subscription = Subscription(node, events)
    await subscription.is_matched()
    subscription.on_ready = lambda: None  # type: ignore[method-assign]
    subscription.publisher.publish(Int32())
    await eventually(lambda: subscription.calls > 0)  # and a call is planned most of the time
    subscription.source.notify_again()
    subscription.source.close()
    subscription.source.close()
    subscription.source.notify()
    calls = subscription.calls
    await eventually(lambda: subscription.publisher.get_subscription_count() == 0)
    for _ in range(10):
        await asyncio.sleep(0)
    assert subscription.calls == calls
    assert not events._awaited


async def test_closing_waits_a_second_at_most_for_the_thread_to_let_go(node, events, monkeypatch):
    waits_s: list[float | None] = []

    class LetGo(threading.Event):
        def wait(self, timeout: float | None = None) -> bool:
            waits_s.append(timeout)
            return super().wait(timeout)

    subscription = Subscription(node, events)
    monkeypatch.setattr(threading, "Event", LetGo)
    subscription.source.close()
    assert [wait_s for wait_s in waits_s if wait_s is not None] == [1.0]


async def test_a_wait_that_fails_is_tried_again_a_second_later(node, events, monkeypatch, caplog):
    pauses_s: list[float | None] = []

    class Stopping(threading.Event):
        def wait(self, timeout: float | None = None) -> bool:
            pauses_s.append(timeout)
            return False

    failures = iter([RuntimeError("no wait sets today")] * 2)

    def wait(entities: object) -> Sequence[int]:
        for error in failures:
            raise error
        return wait_set(entities)

    wait_set: Any = events._wait_set.wait
    monkeypatch.setattr(events, "_stopping", Stopping())
    monkeypatch.setattr(events._wait_set, "wait", wait)
    subscription = Subscription(node, events)
    await subscription.is_matched()
    subscription.publisher.publish(Int32())
    await eventually(lambda: subscription.calls > 0)
    assert pauses_s == [1.0, 1.0]
    assert caplog.messages == ["waiting for messages failed"] * 2
    assert events.faults() == ()
    subscription.source.close()


async def test_if_ros_has_ended_the_thread_ends_with_a_fault(node, events, monkeypatch):
    def fail(entities: object) -> Sequence[int]:
        raise RuntimeError("the context is not valid")

    monkeypatch.setattr(events._wait_set, "wait", fail)
    node.context.try_shutdown()
    events._wait_set.wake()
    await eventually(lambda: events.faults() != ())
    (fault,) = events.faults()
    assert fault.severity == "dead"
    assert fault.text == "the thread that waits for messages has ended"
