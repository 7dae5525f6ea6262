# SPDX-License-Identifier: Apache-2.0
"""The counts of DDS, with publishers and subscriptions outside that break their promises."""

import asyncio
import signal
import subprocess
import sys
import time
from collections.abc import AsyncIterator, Iterator
from contextlib import closing
from types import SimpleNamespace

import pytest
from rclpy.duration import Duration
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.qos import LivelinessPolicy, QoSProfile
from std_msgs.msg import Int32

from gateway.sources.rclpy import RosOptions
from gateway.sources.rclpy.port import RclpyRos
from gateway.sources.rclpy.qos_events import QosEvents, QosWatch, _Count, _messages_lost
from gateway.sources.source import Qos, TopicEvent
from tests.client import eventually
from tests.sources.conftest import needs_qos
from tests.sources.outside import Outside
from tests.sources.rclpy.lossy_subscriber import LOSSY

INT32 = "std_msgs/msg/Int32"
STRING = "std_msgs/msg/String"
SECOND = 1_000_000_000
TENTH_NS = 100_000_000


@pytest.fixture
async def ros() -> AsyncIterator[RclpyRos]:
    ros = RclpyRos(RosOptions())
    yield ros
    ros.close()


@pytest.fixture
def outside() -> Iterator[Outside]:
    with closing(Outside()) as outside:
        yield outside


def of(code: str, events: list[TopicEvent]) -> list[TopicEvent]:
    return [event for event in events if event.code == code]


@needs_qos
async def test_a_missed_deadline_is_told_to_who_has_asked_for_it(ros: RclpyRos, outside: Outside):
    events: list[TopicEvent] = []
    heard: list[object] = []
    asked = Qos(deadline_ns=TENTH_NS)
    subscription = ros.subscribe("/t", INT32, asked, heard.extend, events.append)
    offer = QoSProfile(depth=1, deadline=Duration(nanoseconds=TENTH_NS))
    publisher = outside.node.create_publisher(Int32, "/t", offer)

    def is_told() -> bool:
        if not heard:
            publisher.publish(Int32(data=1))
        return bool(of("deadline_missed", events))

    await eventually(is_told)
    event = of("deadline_missed", events)[0]
    assert event.text.startswith("topic /t: no message within the deadline of 100 ms")
    subscription.close()


@needs_qos
async def test_a_missed_promise_is_told_to_every_client_that_gave_it(ros: RclpyRos):
    qos = Qos(deadline_ns=TENTH_NS)
    told: list[list[TopicEvent]] = [[], []]
    publishers = [ros.advertise("/t", INT32, qos, each.append) for each in told]
    publishers[0].publish(b"\0\1\0\0\1\0\0\0")
    await eventually(lambda: all(of("deadline_missed", each) for each in told))
    text = "topic /t: nothing was published within the deadline of 100 ms"
    assert told[0][0].text.startswith(text)
    for publisher in publishers:
        publisher.close()


@needs_qos
async def test_a_publisher_that_gives_no_sign_of_life_is_told(ros: RclpyRos, outside: Outside):
    events: list[TopicEvent] = []
    subscription = ros.subscribe("/t", INT32, Qos(), lambda samples: None, events.append)
    offer = QoSProfile(
        depth=1,
        liveliness=LivelinessPolicy.MANUAL_BY_TOPIC,
        liveliness_lease_duration=Duration(nanoseconds=2 * TENTH_NS),
    )
    publisher = outside.node.create_publisher(Int32, "/t", offer)
    await eventually(lambda: subscription.qos.lease_ns == 2 * TENTH_NS)  # it was adopted

    # A sample may come to the reader that is being replaced, so one a second, which is many leases.
    due_s = 0.0

    def is_told() -> bool:
        nonlocal due_s
        if time.monotonic() >= due_s:
            publisher.publish(Int32(data=1))
            due_s = time.monotonic() + 1
        return bool(of("liveliness_lost", events))

    await eventually(is_told)
    text = "topic /t: a publisher has given no sign of life in time"
    assert of("liveliness_lost", events)[0].text == text
    plain = outside.node.create_publisher(Int32, "/t", 1)
    await eventually(lambda: subscription.qos.lease_ns is None)  # or that one would not match
    assert plain is not None


async def test_a_subscription_that_asks_for_signs_of_life_is_told_to_the_client(ros, outside):
    events: list[TopicEvent] = []
    publisher = ros.advertise("/t", INT32, Qos(), events.append)
    for liveliness, lease_ns in (
        (LivelinessPolicy.AUTOMATIC, TENTH_NS),
        (LivelinessPolicy.MANUAL_BY_TOPIC, 2 * TENTH_NS),
    ):
        lease = Duration(nanoseconds=lease_ns)
        asked = QoSProfile(depth=1, liveliness=liveliness, liveliness_lease_duration=lease)
        outside.node.create_subscription(Int32, "/t", lambda _: None, asked)
    await eventually(lambda: len(events) == 2)
    assert {event.problem.split(", ")[0] for event in events} == {
        "topic /t: /outside asks for automatic liveliness with a lease of 100 ms",
        "topic /t: /outside asks for manual liveliness with a lease of 200 ms",
    }
    publisher.close()


async def test_messages_that_are_lost_on_the_way_are_told(outside: Outside):
    publisher = outside.add_publisher("/t", STRING, LOSSY)
    small = b"\0\1\0\0\1\0\0\0\0"
    size = 6_000_000  # of one message: more than any buffer on the way takes
    large = b"\0\1\0\0" + size.to_bytes(4, "little") + b"x" * (size - 1) + b"\0"
    subscriber = await asyncio.create_subprocess_exec(
        *(sys.executable, "-m", "tests.sources.rclpy.lossy_subscriber"), stdout=subprocess.PIPE
    )
    told: list[str] = []

    async def listen() -> None:
        assert subscriber.stdout is not None
        async for line in subscriber.stdout:
            told.append(line.decode().rstrip())  # noqa: PERF401  # seen while it goes on

    def is_told() -> bool:
        if "heard" in told:
            subscriber.send_signal(signal.SIGSTOP)  # it cannot keep pace, however fast it is
            for _ in range(10):
                publisher.publish(large)
            subscriber.send_signal(signal.SIGCONT)
        publisher.publish(small)
        return any(line.startswith("messages_lost ") for line in told)

    listening = asyncio.create_task(listen())
    try:
        await eventually(is_told)
    finally:
        subscriber.kill()
        await subscriber.wait()
        await listening
    lost = next(line for line in told if line.startswith("messages_lost "))
    assert lost.endswith(
        ' lost on the way here; ask for "reliability":"reliable" in "qos" if its publishers offer'
        " that, or have it publish less"
    )


@pytest.mark.parametrize(
    ("qos", "remedy"),
    [
        (Qos("best_effort", depth=5), '"reliability":"reliable" in "qos" if its publishers offer'),
        (Qos("reliable", depth=5), 'ask for "depth":10 in "qos", or have it publish less'),
        (Qos("reliable", depth=600), 'ask for "depth":1024 in "qos", or have it publish less'),
        (Qos("reliable", depth=1024), "here; have it publish less"),
        (Qos("reliable", history="keep_all"), "here; have it publish less"),
    ],
)
def test_a_loss_is_reported_with_a_remedy(qos: Qos, remedy: str):
    event = _messages_lost("/odom", qos, 7)
    assert event.problem == "topic /odom: 7 messages were lost on the way here"
    assert remedy in event.text


async def test_a_middleware_without_these_events_serves_topics_all_the_same(ros, monkeypatch):
    def refuse(*_: object) -> None:
        raise rclpy_implementation.UnsupportedEventTypeError("not here")

    monkeypatch.setattr(rclpy_implementation, "EventHandle", refuse)
    heard: list[object] = []
    asked = Qos(deadline_ns=10**12)
    ros.subscribe("/t", INT32, asked, heard.extend, lambda _: None)
    publisher = ros.advertise("/t", INT32, asked, lambda _: None)

    def arrives() -> bool:
        publisher.publish(b"\0\1\0\0\1\0\0\0")
        return bool(heard)

    await eventually(arrives)
    ros._subscriptions.events._look()


async def test_nothing_is_looked_at_once_all_is_closed(ros: RclpyRos):
    events = ros._subscriptions.events
    assert events._timer is None
    subscription = ros.subscribe("/t", INT32, Qos(), lambda _: None, lambda _: None)
    publisher = ros.advertise("/u", INT32, Qos(deadline_ns=TENTH_NS), lambda _: None)
    assert len(events._open) == 2
    subscription.close()
    publisher.close()
    assert (events._timer, len(events._open)) == (None, 0)


async def test_a_lasting_problem_is_reported_again_after_5_s_with_its_number():
    counted = iter([1, 1, 3, 0, 0, 2])
    told: list[TopicEvent] = []
    destroyed: list[bool] = []
    count = _Count(
        lambda: next(counted),
        lambda: destroyed.append(True),
        lambda times: TopicEvent("messages_lost", f"{times}"),
    )
    watch = QosWatch(QosEvents(asyncio.get_running_loop()), told.append, [count])
    for now_ns in (0, 1, 5 * SECOND - 1):
        watch.look(now_ns)
    assert [event.text for event in told] == ["1"]
    for now_ns in (5 * SECOND, 10 * SECOND, 10 * SECOND + 1):
        watch.look(now_ns)
    assert [event.text for event in told] == ["1", "4", "2"]
    watch.close()
    watch.close()
    watch.look(45 * SECOND)
    assert destroyed == [True]


async def test_a_callback_may_close_what_reports_to_it():
    is_closed = False

    def take() -> int:
        assert not is_closed, "rclpy raises InvalidHandle"
        return 1

    def destroy() -> None:
        nonlocal is_closed
        is_closed = True

    told: list[TopicEvent] = []

    def on_event(event: TopicEvent) -> None:
        told.append(event)
        watch.close()

    counts = [
        _Count(take, destroy, lambda times: TopicEvent("messages_lost", f"{times}"))
        for _ in range(2)
    ]
    watch = QosWatch(QosEvents(asyncio.get_running_loop()), on_event, counts)
    watch.look(0)
    assert len(told) == 1


def test_counts_are_looked_at_twice_a_second():
    delays_s: list[float] = []
    loop = SimpleNamespace(call_later=lambda delay_s, _: delays_s.append(delay_s))
    events = QosEvents(loop)  # type: ignore[arg-type]
    events._watch(print, [])
    events._look()
    assert delays_s == [0.5, 0.5]
