# SPDX-License-Identifier: Apache-2.0
"""Following the publishers: what happens while one subscription replaces another."""

import asyncio
import sys
import time
from collections.abc import AsyncIterator, Callable, Sequence
from pathlib import Path
from typing import Any

import pytest

from gateway.sources.qos import Endpoint
from gateway.sources.rclpy import RosOptions, raw_subscriptions
from gateway.sources.rclpy.port import RclpyRos
from gateway.sources.rclpy.raw_subscriptions import RawSubscription
from gateway.sources.source import MAX_TAKES_PER_TURN, Qos, Sample, TopicEvent
from tests.client import TIMEOUT_S, eventually
from tests.sources.conftest import needs_qos
from tests.sources.outside import Outside

INT32 = "std_msgs/msg/Int32"
BEST_EFFORT = Endpoint("/scanner", INT32, "best_effort")
RELIABLE = Endpoint("/driver", INT32)
COUNTING = Endpoint("/counting", INT32)
WAITING = 100


@pytest.fixture
async def ros() -> AsyncIterator[RclpyRos]:
    ros = RclpyRos(RosOptions())
    yield ros
    ros.close()


class Fed:
    """A subscription whose samples wait, because the loop has been kept from taking them."""

    def __init__(self, ros: RclpyRos, outside: Outside) -> None:
        self.received: list[int] = []
        self.then: Callable[[], None] = lambda: None
        self.subscription: RawSubscription = ros.subscribe(
            "/scan", INT32, Qos(depth=WAITING), self._on_samples, lambda _: None
        )
        self._publisher = outside.add_publisher("/scan", INT32, Qos(depth=WAITING))

    def _on_samples(self, samples: Sequence[Sample]) -> None:
        self.received += map(number, samples)
        self.then()

    async def fill(self) -> None:
        """Let `WAITING` samples wait. Nobody may await before they are looked for."""

        def flows() -> bool:
            self._publish(WAITING)
            return bool(self.received)

        await eventually(flows)
        self._publish(WAITING + 1)
        await eventually(lambda: WAITING + 1 in self.received)
        self.received.clear()
        for value in range(WAITING):
            self._publish(value)
        until = time.monotonic() + TIMEOUT_S
        while waiting(self.subscription._reader) < WAITING and time.monotonic() < until:
            time.sleep(0.001)  # noqa: ASYNC251  # the loop is to be kept busy

    def _publish(self, value: int) -> None:
        self._publisher.publish(cdr(value))


def cdr(value: int) -> bytes:
    return b"\0\1\0\0" + value.to_bytes(4, "little")


def number(sample: Sample) -> int:
    return int.from_bytes(sample.cdr[4:8], "little")


def waiting(reader: Any) -> int:
    """Count what has arrived and was not taken."""
    lines = Path(f"/proc/self/fdinfo/{reader._source._fd}").read_text().splitlines()
    return int(next(line for line in lines if line.startswith("eventfd-count:")).split()[1], 16)


async def test_samples_that_wait_while_the_profile_is_replaced_are_not_lost(ros, outside):
    fed = Fed(ros, outside)
    await fed.fill()
    fed.subscription.follow([RELIABLE, BEST_EFFORT])
    assert fed.subscription.qos.reliability == "best_effort"
    await eventually(lambda: fed.received == list(range(WAITING)))


async def test_each_message_comes_once_and_in_order_while_the_profile_is_replaced(ros, monkeypatch):
    assert raw_subscriptions.RETIREMENT_S == 4.0
    monkeypatch.setattr(raw_subscriptions, "RETIREMENT_S", 1.0)
    received: list[int] = []

    def take(samples: Sequence[Sample]) -> None:
        received.extend(map(number, samples))

    subscription: Any = ros.subscribe("/scan", INT32, Qos(depth=1000), take, lambda _: None)
    publisher = await asyncio.create_subprocess_exec(
        sys.executable, "-m", "tests.sources.rclpy.counting_publisher"
    )
    try:
        await eventually(lambda: len(received) > 100)
        for offers in [[COUNTING, BEST_EFFORT], [COUNTING]] * 2:
            subscription.follow(offers)
            await eventually(lambda: subscription._retired is subscription._timer is None)
    finally:
        publisher.kill()
        await publisher.wait()
    assert received == list(range(received[0], received[0] + len(received)))


@needs_qos
async def test_samples_that_a_retired_reader_never_gets_do_not_wait_for_it(
    ros, outside, monkeypatch
):
    monkeypatch.setattr(raw_subscriptions, "RETIREMENT_S", 1e6)
    received: list[int] = []

    def take(samples: Sequence[Sample]) -> None:
        received.extend(map(number, samples))

    subscription: Any = ros.subscribe("/scan", INT32, Qos(), take, lambda _: None)
    latched = outside.add_publisher("/scan", INT32, Qos(durability="transient_local", depth=9))
    for value in range(3):  # before they have discovered each other
        latched.publish(cdr(value))
    await eventually(lambda: received == [0, 1, 2])
    assert subscription.qos.durability == "transient_local"
    volatile = outside.add_publisher("/scan", INT32)

    def flows() -> bool:
        volatile.publish(cdr(9))
        return 9 in received

    await eventually(flows)
    assert subscription.qos.durability == "volatile"
    assert subscription._retired is not None


async def test_closing_while_the_profile_is_replaced_ends_the_samples(ros, outside):
    fed = Fed(ros, outside)
    await fed.fill()
    fed.then = fed.subscription.close
    fed.subscription.follow([BEST_EFFORT])
    await eventually(lambda: bool(fed.received))
    fed.subscription.follow([RELIABLE])  # too late
    assert fed.received == list(range(MAX_TAKES_PER_TURN))
    assert ros.entity_count() == 0
    assert fed.subscription._reader is fed.subscription._retired is None


async def test_a_callback_that_raises_leaves_no_third_reader(ros, outside):
    def fail() -> None:
        raise LookupError

    fed = Fed(ros, outside)
    await fed.fill()
    retired: Any = fed.subscription._reader
    fed.then = fail
    fed.subscription.follow([BEST_EFFORT])
    with pytest.raises(LookupError):
        fed.subscription.follow([RELIABLE])
    assert retired._is_closed
    assert not fed.subscription._reader._is_closed  # type: ignore[union-attr]
    assert fed.subscription._retired is None


async def test_closing_by_the_last_samples_of_a_retired_one_leaves_no_reader(ros, outside):
    fed = Fed(ros, outside)
    await fed.fill()
    fed.then = fed.subscription.close
    fed.subscription.follow([BEST_EFFORT])
    fed.subscription.follow([RELIABLE])
    assert fed.received == list(range(MAX_TAKES_PER_TURN))
    assert fed.subscription._reader is fed.subscription._retired is None


async def test_a_refused_replacement_is_told_once_while_it_stands(ros, monkeypatch):
    def refuse(*_: object) -> None:
        raise RuntimeError("no memory")

    reasons: list[TopicEvent] = []
    subscription = ros.subscribe("/scan", INT32, Qos(), lambda _: None, reasons.append)
    monkeypatch.setattr(ros._subscriptions._samples, "read", refuse)
    refusal = TopicEvent(
        "qos_incompatible", "topic /scan: no memory", "keeping reliability reliable"
    )
    for _ in range(3):
        subscription.follow([BEST_EFFORT])
    assert reasons.count(refusal) == 1
    subscription.follow([RELIABLE])
    subscription.follow([BEST_EFFORT])
    assert reasons.count(refusal) == 2
    assert subscription.qos.reliability == "reliable"
