# SPDX-License-Identifier: Apache-2.0
"""From DDS to the loop: what the contract cannot see."""

import asyncio
import contextlib
import os
import threading
from collections.abc import AsyncIterator, Iterator
from functools import partial
from typing import Any

import pytest
from rclpy.context import Context
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node

from gateway.config.limits import MAX_QUEUE_DEPTH
from gateway.sources.qos import adopt
from gateway.sources.rclpy.interfaces import message_class
from gateway.sources.rclpy.large_takes import LARGE_SAMPLE_BYTES
from gateway.sources.rclpy.profile import to_profile
from gateway.sources.rclpy.ready_events import ReadyEvents
from gateway.sources.rclpy.samples import Reader, Samples
from gateway.sources.source import MAX_TAKES_PER_TURN, Qos, Sample
from tests.client import TIMEOUT_S, eventually
from tests.sources.nodes import open_node
from tests.sources.outside import Outside, OutsidePublisher

INT32 = "std_msgs/msg/Int32"
INFO = {"received_timestamp": 0, "source_timestamp": 0, "publication_sequence_number": 1}
CDR = b"\0\1\0\0\7\0\0\0"
CLASS = message_class(INT32)


@pytest.fixture
def node() -> Iterator[Node]:
    context = Context()
    context.init(args=["--ros-args", "--disable-stdout-logs"])
    node = open_node("reading", context, start_parameter_services=False)
    yield node
    node.destroy_node()
    context.try_shutdown()
    context.destroy()


def samples_of(node: Node) -> Samples:
    return Samples(node, ReadyEvents(asyncio.get_running_loop()))


class Flood:
    """A publisher that never pauses, in a separate thread."""

    def __init__(self, publisher: OutsidePublisher) -> None:
        self._publisher = publisher
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def close(self) -> None:
        self._stop.set()
        self._thread.join()

    def _run(self) -> None:
        while not self._stop.is_set():
            self._publisher.publish(CDR)


@pytest.fixture
def flood(outside: Outside) -> Iterator[Flood]:
    flood = Flood(outside.add_publisher("/flood", INT32))
    yield flood
    flood.close()


async def test_samples_that_came_before_the_callback_was_set_are_taken(node, outside):
    latched = Qos(durability="transient_local", depth=5)
    publisher = outside.add_publisher("/map", INT32, latched)
    for _ in range(3):
        publisher.publish(CDR)
    profile = to_profile(adopt(latched, ()))
    samples = samples_of(node)
    # Let DDS have them while nobody asks, then hook a reader on that same subscription.
    subscription = node.create_subscription(CLASS, "/map", lambda _: None, profile, raw=True)
    node.create_subscription = lambda *_, **__: subscription  # type: ignore[method-assign]
    await asyncio.to_thread(wait_for_a_sample, node, subscription)
    received: list[Sample] = []
    reader = samples.read(CLASS, "/map", profile, received.extend)
    await eventually(lambda: len(received) == 3)
    reader.close()


def wait_for_a_sample(node: Node, subscription: object) -> None:
    context = node.context.handle
    wait_set = rclpy_implementation.WaitSet(1, 0, 0, 0, 0, 0, context)
    with wait_set:
        wait_set.clear_entities()
        wait_set.add_subscription(subscription.handle)  # type: ignore[attr-defined]
        wait_set.wait(30 * 10**9)
        assert wait_set.get_ready_entities("subscription")


async def test_no_stale_callback_writes_into_a_descriptor_that_reuses_the_number(
    node: Node, outside: Outside, flood: Flood
) -> None:
    samples = samples_of(node)
    profile = to_profile(adopt(Qos(), ()))
    for _ in range(20):
        received: list[Sample] = []
        reader = samples.read(CLASS, "/flood", profile, received.extend)
        await eventually(lambda: bool(received))  # noqa: B023  # awaited before the next round
        fd = reader._source._fd  # type: ignore[attr-defined]
        witness: list[Sample] = []
        other = samples.read(CLASS, "/flood", profile, witness.extend)
        reader.close()
        reused = os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)
        try:
            assert reused == fd
            await eventually(lambda: len(witness) > 50)  # noqa: B023
            with pytest.raises(BlockingIOError):
                os.eventfd_read(reused)
        finally:
            os.close(reused)
            other.close()


async def test_a_reader_unhooks_then_destroys_then_closes(node, monkeypatch):
    loop = asyncio.get_running_loop()
    samples = samples_of(node)
    steps: list[tuple[str, object]] = []

    def record(owner: object, name: str) -> None:
        act = getattr(owner, name)

        def recorded(*subject: object) -> None:
            steps.append((name, subject[-1]))
            act(*subject)

        monkeypatch.setattr(owner, name, recorded)

    record(samples.ready_events._hooks, "stop")
    record(node, "destroy_subscription")
    record(os, "close")
    reader = samples.read(CLASS, "/count", to_profile(adopt(Qos(), ())), lambda _: None)
    fd = reader._source._fd  # type: ignore[attr-defined]
    subscription = reader._subscription  # type: ignore[attr-defined]
    reader.close()
    assert [step for step in steps if step[1] in (fd, subscription)] == [
        ("stop", subscription),
        ("destroy_subscription", subscription),
        ("close", fd),
    ]
    assert not loop.remove_reader(fd)
    reader.close()
    assert len(steps) == 3


async def test_a_reader_that_cannot_be_hooked_leaves_nothing(node, monkeypatch):
    def refuse(*_: object) -> None:
        raise RuntimeError("no callbacks today")

    loop = asyncio.get_running_loop()
    samples = samples_of(node)
    free = os.eventfd(0)
    os.close(free)
    monkeypatch.setattr(samples.ready_events._hooks, "count", refuse)
    with pytest.raises(RuntimeError, match="no callbacks today"):
        samples.read(CLASS, "/count", to_profile(adopt(Qos(), ())), lambda _: None)
    assert list(node.subscriptions) == []
    assert not loop.remove_reader(free)
    again = os.eventfd(0)
    os.close(again)
    assert again == free


async def test_a_flush_ends_though_the_samples_do_not(node: Node) -> None:
    received: list[Sample] = []
    reader = samples_of(node).read(CLASS, "/count", to_profile(adopt(Qos(), ())), received.extend)
    reader._take_message = lambda *_: (CDR, INFO)  # type: ignore[attr-defined]
    reader.flush()
    assert len(received) == MAX_QUEUE_DEPTH
    reader.close()


async def test_a_flood_leaves_the_loop_to_others(node, outside, flood):
    samples = samples_of(node)
    batches: list[int] = []
    profile = to_profile(adopt(Qos(depth=1000), ()))
    reader = samples.read(CLASS, "/flood", profile, lambda batch: batches.append(len(batch)))
    turns = 0
    while len(batches) < 100:
        turns += 1
        await asyncio.sleep(0)
    assert max(batches) <= MAX_TAKES_PER_TURN
    assert turns >= 100  # every batch was followed by another turn
    reader.close()


async def test_an_exception_in_one_callback_does_not_stop_the_samples(node, outside, flood):
    loop = asyncio.get_running_loop()
    raised: list[object] = []
    loop.set_exception_handler(lambda _, context: raised.append(context["exception"]))
    calls: list[int] = []

    def on_samples(batch: object) -> None:
        calls.append(1)
        raise LookupError

    reader = samples_of(node).read(
        CLASS, "/flood", to_profile(adopt(Qos(depth=1000), ())), on_samples
    )
    await eventually(lambda: len(calls) > 3)
    reader.close()
    assert all(isinstance(each, LookupError) for each in raised)


STRING = "std_msgs/msg/String"
TEXT = message_class(STRING)


def text(size: int, char: bytes) -> bytes:
    """Return a String of so many bytes."""
    length = size - 8
    return b"\0\1\0\0" + length.to_bytes(4, "little") + char * (length - 1) + b"\0"


class PausedTakes:
    """Takes large samples as in the product, but each only after it was let."""

    def __init__(self, samples: Samples) -> None:
        self.begun = threading.Semaphore(0)
        self.let = threading.Semaphore(0)
        self.error: Exception | None = None
        self._take = samples.large_takes._take
        samples.large_takes._take = self._take_when_let

    def _take_when_let(self, *args: Any) -> Sample | None:
        self.begun.release()
        assert self.let.acquire(timeout=TIMEOUT_S)
        if self.error is not None:
            raise self.error
        return self._take(*args)

    async def has_begun(self) -> None:
        assert await asyncio.to_thread(self.begun.acquire, timeout=TIMEOUT_S)


@pytest.fixture
async def samples(node: Node) -> AsyncIterator[Samples]:
    with contextlib.closing(samples_of(node)) as samples:
        yield samples


async def test_samples_behind_a_large_one_are_taken_while_the_loop_serves_others(samples, outside):
    held = PausedTakes(samples)
    received: list[Sample] = []
    qos = Qos(reliability="reliable", durability="volatile", depth=10)
    publisher = outside.add_publisher("/cloud", STRING, qos)
    reader = samples.read(TEXT, "/cloud", to_profile(adopt(qos, ())), received.extend)
    await eventually(lambda: reader.publishers == publisher.subscribers == 1)
    sent = [text(LARGE_SAMPLE_BYTES + index, b"abcdef"[index : index + 1]) for index in range(6)]
    publisher.publish(sent[0])  # on the loop: nobody knows yet
    await eventually(lambda: len(received) == 1)
    for cdr in sent[1:]:
        publisher.publish(cdr)
    await held.has_begun()
    assert len(received) == 1  # and this runs on the loop, while the thread takes
    for _ in range(100):  # also to find that there is no more
        held.let.release()
    await eventually(lambda: len(received) == 6)
    publisher.publish(text(100, b"g"))
    await eventually(lambda: len(received) == 7)
    begun = held.begun
    while begun.acquire(blocking=False):
        pass
    publisher.publish(text(100, b"h"))  # small ones follow a small one: on the loop again
    await eventually(lambda: len(received) == 8)
    assert not begun.acquire(blocking=False)
    assert [bytes(sample.cdr) for sample in received[:6]] == sent
    assert [sample.number for sample in received] == list(range(1, 9))
    reader.close()


async def test_the_first_sample_of_a_latched_topic_does_not_hold_the_loop(samples, outside):
    held = PausedTakes(samples)
    latched = Qos(durability="transient_local", depth=1)
    outside.add_publisher("/map", STRING, latched).publish(text(2 * LARGE_SAMPLE_BYTES, b"m"))
    received: list[Sample] = []
    reader = samples.read(TEXT, "/map", to_profile(adopt(latched, ())), received.extend)
    await held.has_begun()
    assert received == []
    for _ in range(5):  # DDS may tell of it several times
        held.let.release()
    await eventually(lambda: len(received) == 1)
    reader.close()


async def test_a_flush_waits_for_what_the_thread_is_taking(samples, outside):
    held = PausedTakes(samples)
    latched = Qos(reliability="reliable", durability="transient_local", depth=10)
    publisher = outside.add_publisher("/map", STRING, latched)
    received: list[Sample] = []
    reader = samples.read(TEXT, "/map", to_profile(adopt(latched, ())), received.extend)
    publisher.publish(text(100, b"a"))
    await held.has_begun()
    threading.Timer(0.05, held.let.release).start()
    reader.flush()
    await eventually(lambda: len(received) == 1)
    reader.flush()
    assert len(received) == 1  # not twice
    reader.close()


async def test_a_reader_that_closes_delivers_nothing_that_the_thread_is_taking(samples, outside):
    held = PausedTakes(samples)
    latched = Qos(durability="transient_local", depth=1)
    outside.add_publisher("/map", STRING, latched).publish(text(100, b"a"))
    received: list[Sample] = []
    first, second = (
        samples.read(TEXT, "/map", to_profile(adopt(latched, ())), received.extend)
        for _ in range(2)
    )
    await held.has_begun()  # one of them. The other waits for the thread
    threading.Timer(0.05, held.let.release, [20]).start()
    first.close()
    second.close()
    await asyncio.to_thread(samples.close)
    await asyncio.sleep(0)
    assert received == []


async def test_after_a_failed_take_the_loop_takes_the_samples_that_have_come(samples, outside):
    loop = asyncio.get_running_loop()
    raised: list[object] = []
    loop.set_exception_handler(lambda _, context: raised.append(context["exception"]))
    held = PausedTakes(samples)
    held.error = RuntimeError("no memory")
    latched = Qos(reliability="reliable", durability="transient_local", depth=10)
    publisher = outside.add_publisher("/map", STRING, latched)
    received: list[Sample] = []
    reader = samples.read(TEXT, "/map", to_profile(adopt(latched, ())), received.extend)
    publisher.publish(text(100, b"a"))
    await held.has_begun()
    publisher.publish(text(100, b"b"))
    await eventually(lambda: reader._asks_again)
    held.let.release()
    await eventually(lambda: len(received) == 2)
    assert raised == [held.error]
    reader.close()


def takes(one: object) -> Any:
    """Return a function that takes five, of which the third comes at the second attempt."""
    results = iter([one, one, RuntimeError("no memory"), one, one, one])

    def take(*_: object) -> object:
        result = next(results, None)
        if isinstance(result, Exception):
            raise result
        return result

    return take


def by_the_thread(reader: Reader, samples: Samples) -> None:
    reader._are_large = True
    samples.large_takes._take = takes(Sample(bytes(LARGE_SAMPLE_BYTES), 0, 0, 1))


def on_the_loop(reader: Reader, samples: Samples) -> None:
    reader._take_message = takes((CDR, INFO))


def with_publishers(reader: Reader, samples: Samples) -> None:
    reader._take_with_publisher = takes(Sample(CDR, 0, 0, 1))
    reader.deliver_to(reader._on_samples, with_publishers=True)


@pytest.mark.parametrize("take", [by_the_thread, on_the_loop, with_publishers])
async def test_samples_before_and_behind_a_failed_take_are_delivered(take, samples):
    received: list[Sample] = []
    reader = samples.read(CLASS, "/map", to_profile(adopt(Qos(), ())), received.extend)
    take(reader, samples)
    reader._source.notify_again()
    await eventually(lambda: len(received) == 5)
    reader.close()


async def test_samples_that_arrive_while_the_thread_takes_bring_one_further_take(
    samples: Samples, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(samples.large_takes, "_take", lambda *_: None)  # all has been taken
    reader = samples.read(TEXT, "/cloud", to_profile(adopt(Qos(), ())), lambda _: None)
    steps: list[str] = []
    monkeypatch.setattr(reader._source, "notify_again", partial(steps.append, "notify_again"))
    reader._take_large()
    reader._take_large()  # more has arrived
    await eventually(lambda: steps == ["notify_again"])
    reader._take_large()
    await eventually(lambda: reader._large is None)
    assert steps == ["notify_again"]
    reader.close()


async def test_a_reader_that_closes_waits_for_one_sample_alone(samples, outside):
    held = PausedTakes(samples)
    latched = Qos(reliability="reliable", durability="transient_local", depth=10)
    publisher = outside.add_publisher("/map", STRING, latched)
    for _ in range(4):
        publisher.publish(text(100, b"a"))
    reader = samples.read(TEXT, "/map", to_profile(adopt(latched, ())), print)
    await held.has_begun()
    threading.Timer(0.05, held.let.release).start()
    reader.close()
    assert not held.begun.acquire(blocking=False)
