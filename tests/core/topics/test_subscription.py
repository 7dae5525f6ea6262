# SPDX-License-Identifier: Apache-2.0
"""One subscription by itself."""

import time
from typing import Any

import pytest

from gateway.core.names import TopicName
from gateway.core.requests import Subscribe
from gateway.core.topic_counts import TopicCounts
from gateway.core.topics.subscription import Subscription
from gateway.core.topics.subscription_options import SubscriptionOptions
from gateway.fronts.rosbridge.framing import RosbridgeFraming
from tests.client import eventually
from tests.clock import StoppedClock
from tests.core.conftest import lone_session
from tests.core.entries import Item

MS = 1_000_000
EVERYTHING = 1 << 30


def requested(**options: Any) -> tuple[dict[str | int | None, Subscribe], SubscriptionOptions]:
    request = Subscribe(topic="/t", framing=RosbridgeFraming(), **options)
    return {None: request}, SubscriptionOptions.merge([request])


def subscribed(**options: Any) -> Subscription:
    session = lone_session()
    asked = requested(**options)
    return Subscription(session, "/t", TopicName("/t"), *asked, TopicCounts(), lambda _: None)


def offer(subscription: Subscription, number: int, now_ns: int = 0) -> None:
    subscription.offer(Item(number), now_ns, more=False)


def waiting(subscription: Subscription) -> list[bytes]:
    return subscription.session.outbox.take(EVERYTHING)


def test_without_a_throttle_every_entry_passes():
    subscription = subscribed()
    for number in range(3):
        offer(subscription, number)
    assert waiting(subscription) == [b"0", b"1", b"2"]


def test_queue_length_bounds_the_queue():
    subscription = subscribed(queue_length=3)
    for number in range(10):
        offer(subscription, number)
    assert waiting(subscription) == [b"7", b"8", b"9"]


def test_changed_options_keep_what_waits():
    subscription = subscribed()
    offer(subscription, 1)
    subscription.change(*requested(throttle_ms=100, queue_length=7))
    assert subscription.queue.depth == 7
    assert waiting(subscription) == [b"1"]


async def test_an_entry_that_a_throttle_holds_passes_at_the_end_of_its_interval(
    monkeypatch: pytest.MonkeyPatch,
):
    clock = StoppedClock(monkeypatch)
    subscription = subscribed(throttle_ms=100)
    offer(subscription, 1, 1000 * MS)
    offer(subscription, 2, 1060 * MS)
    await clock.advance(0.039)
    assert waiting(subscription) == [b"1"]
    await clock.advance(0.002)
    assert waiting(subscription) == [b"2"]


async def test_entries_that_a_throttle_queues_pass_one_by_one_until_nothing_waits():
    subscription = subscribed(throttle_ms=5, queue_length=10)
    seen: list[bytes] = []

    def count() -> int:
        seen.extend(waiting(subscription))
        return len(seen)

    for number in range(4):
        offer(subscription, number, time.monotonic_ns())
    assert subscription.delivery.pending > 0
    await eventually(lambda: count() == 4)
    assert seen == [b"0", b"1", b"2", b"3"]
    assert subscription._timer is None


async def test_another_throttle_begins_at_once_and_keeps_the_order():
    subscription = subscribed(throttle_ms=3_600_000)
    offer(subscription, 1, 1000 * MS)
    offer(subscription, 2, 1001 * MS)
    subscription.change(*requested(throttle_ms=3_600_000 - 1))
    offer(subscription, 3, 1002 * MS)
    offer(subscription, 4, 1003 * MS)
    assert waiting(subscription) == [b"1", b"2", b"3"]
    subscription.change(*requested())
    offer(subscription, 5, 1004 * MS)
    assert waiting(subscription) == [b"4", b"5"]
    assert subscription._timer is None


async def test_the_same_throttle_goes_on():
    subscription = subscribed(throttle_ms=3_600_000)
    offer(subscription, 1, 1000 * MS)
    offer(subscription, 2, 1001 * MS)
    subscription.change(*requested(throttle_ms=3_600_000, meta=True))
    offer(subscription, 3, 1002 * MS)
    assert waiting(subscription) == [b"1"]
    assert subscription.queue.coalesced == 1
    subscription.close()


async def test_entries_of_a_cleared_or_closed_queue_are_not_delivered():
    subscription = subscribed(throttle_ms=3_600_000)
    offer(subscription, 1, 1000 * MS)
    offer(subscription, 2, 1001 * MS)
    subscription.clear()
    assert subscription._timer is None
    assert waiting(subscription) == []
    offer(subscription, 3, 1002 * MS)
    subscription.close()
    assert subscription._timer is None
    assert waiting(subscription) == []
