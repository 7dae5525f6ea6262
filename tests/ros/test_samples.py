# SPDX-License-Identifier: Apache-2.0
"""From DDS to the loop: what the contract cannot see."""

import asyncio
import os
import threading
from collections.abc import Iterator

import pytest
from rclpy.context import Context
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node

from gateway.config.limits import MAX_QUEUE_DEPTH
from gateway.ports import MAX_TAKES_PER_TURN, Qos, Sample
from gateway.ros.interfaces import message_class
from gateway.ros.profile import to_profile
from gateway.ros.qos import adopt
from gateway.ros.ready_events import EventfdReadyEvents
from gateway.ros.samples import Samples
from tests.client import eventually
from tests.ros.outside import Outside, OutsidePublisher

INT32 = "std_msgs/msg/Int32"
INFO = {"received_timestamp": 0, "source_timestamp": 0, "publication_sequence_number": 1}
CDR = b"\0\1\0\0\7\0\0\0"
CLASS = message_class(INT32)


@pytest.fixture
def node() -> Iterator[Node]:
    context = Context()
    context.init(args=["--ros-args", "--disable-stdout-logs"])
    node = Node("reading", context=context, start_parameter_services=False)
    yield node
    node.destroy_node()
    context.try_shutdown()
    context.destroy()


def samples_of(node: Node) -> Samples:
    return Samples(node, EventfdReadyEvents(asyncio.get_running_loop()))


class Flood:
    """A publisher that never pauses, in a thread of its own."""

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


async def test_samples_that_came_before_the_callback_was_set_are_taken(
    node: Node, outside: Outside
) -> None:
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


async def test_a_reader_unhooks_then_destroys_then_closes(
    node: Node, monkeypatch: pytest.MonkeyPatch
) -> None:
    loop = asyncio.get_running_loop()
    samples = samples_of(node)
    steps: list[tuple[str, object]] = []

    def record(owner: object, name: str) -> None:
        act = getattr(owner, name)

        def recorded(*subject: object) -> None:
            steps.append((name, subject[-1]))
            act(*subject)

        monkeypatch.setattr(owner, name, recorded)

    record(samples._ready_events._hooks, "stop")
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


async def test_a_reader_that_cannot_be_hooked_leaves_nothing(
    node: Node, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> None:
        raise RuntimeError("no callbacks today")

    loop = asyncio.get_running_loop()
    samples = samples_of(node)
    free = os.eventfd(0)
    os.close(free)
    monkeypatch.setattr(samples._ready_events._hooks, "count", refuse)
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


async def test_a_flood_leaves_the_loop_to_others(
    node: Node, outside: Outside, flood: Flood
) -> None:
    samples = samples_of(node)
    batches: list[int] = []
    profile = to_profile(adopt(Qos(depth=1000), ()))
    reader = samples.read(CLASS, "/flood", profile, lambda batch: batches.append(len(batch)))
    turns = 0
    while len(batches) < 100:
        turns += 1
        await asyncio.sleep(0)
    assert max(batches) <= MAX_TAKES_PER_TURN
    assert turns >= 100  # every batch was followed by a turn of somebody else's
    reader.close()


async def test_what_one_callback_raises_does_not_stop_the_samples(
    node: Node, outside: Outside, flood: Flood
) -> None:
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
