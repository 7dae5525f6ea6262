# SPDX-License-Identifier: Apache-2.0
"""One topic by itself, over the fake ROS."""

import asyncio
from collections.abc import Iterator
from concurrent.futures import Executor, ThreadPoolExecutor
from typing import Any

import pytest

from gateway.codec.types import MessageType, Types
from gateway.core.names import TopicName
from gateway.core.requests import Subscribe
from gateway.core.topic_counts import TopicCounts
from gateway.core.topics import late_join
from gateway.core.topics import topic as topic_module
from gateway.core.topics.large_samples import EncodingResources
from gateway.core.topics.subscription import EncodingKey, Feed, Subscription, TopicKey
from gateway.core.topics.subscription_options import SubscriptionOptions
from gateway.core.topics.topic import TIMED_AT_ONCE, Topic
from gateway.fronts.rosbridge.framing import RosbridgeFraming
from gateway.sources.source import Qos, RosError, Sample
from schemas.installed import InstalledDefinitions
from tests.client import eventually
from tests.core.conftest import lone_session
from tests.sources.fake import FakeRos
from tests.wire import unpacked

SECOND = 1_000_000_000
STRING = "std_msgs/msg/String"
TYPES = Types(InstalledDefinitions())
NAME = TopicName("/t")
PLAIN = EncodingKey(RosbridgeFraming(), "/t", None, None)

RATE_BATCHES = 16


@pytest.fixture
def workers() -> Iterator[Executor]:
    with ThreadPoolExecutor(1) as workers:
        yield workers


@pytest.fixture
async def ros() -> FakeRos:
    return FakeRos()


@pytest.fixture
def topic(ros: FakeRos, workers: Executor) -> Topic:
    return open_topic(ros, workers)


def open_topic(
    ros: FakeRos, workers: Executor, qos: Qos | None = None, type_name: str = STRING
) -> Topic:
    key = TopicKey(NAME, type_name, qos or Qos())
    resources = EncodingResources(workers)
    return Topic(key, string_type(), ros, resources, TopicCounts(), lambda _: None)


def string_type() -> MessageType:
    return TYPES.get(STRING)


def subscription(**options: Any) -> Subscription:
    request = Subscribe(topic="/t", framing=RosbridgeFraming(), **options)
    session = lone_session(level="warning")
    merged = SubscriptionOptions.merge([request])
    requests = {None: request}
    return Subscription(session, "/t", NAME, requests, merged, TopicCounts(), lambda _: None)


def sample(text: str) -> Sample:
    message_type = string_type()
    return Sample(message_type.encode({"data": text}, now_ns=0), 0)


def received(of: Subscription) -> list[Any]:
    frames = [frame for wire in of.session.outbox.take(1 << 20) for frame in unpacked(wire)]
    return [frame["msg"]["data"] for frame in frames if frame["op"] == "publish"]


class Heard:
    """All that a subscription has received."""

    def __init__(self, of: Subscription) -> None:
        self._of = of
        self._texts: list[Any] = []

    @property
    def texts(self) -> list[Any]:
        self._texts += received(self._of)
        return self._texts


def test_a_topic_is_idle_until_its_first_and_after_its_last_subscription(topic: Topic):
    assert topic.is_idle
    one, other = subscription(), subscription()
    topic.add(one, PLAIN)
    topic.add(other, EncodingKey(RosbridgeFraming(), "/t", ("data",), None))
    topic.remove(one, PLAIN)
    assert not topic.is_idle
    topic.remove(other, EncodingKey(RosbridgeFraming(), "/t", ("data",), None))
    assert topic.is_idle


def test_a_subscription_that_was_removed_gets_nothing(topic: Topic):
    one, other = subscription(), subscription()
    for each in (one, other):
        topic.add(each, PLAIN)
    topic.remove(one, PLAIN)
    topic._on_samples([sample("x")])
    assert (received(one), received(other)) == ([], ["x"])


def test_a_topic_that_ros_refuses_is_not_kept(ros: FakeRos, workers: Executor):
    with pytest.raises(RosError):
        open_topic(ros, workers, type_name="none_msgs/msg/None")


LATCHED = Qos(durability="transient_local", depth=2)


@pytest.fixture
async def latched(ros: FakeRos, workers: Executor) -> Topic:
    """Return a topic that has received "b" and "c", which its publisher keeps, and "a"."""
    publisher = ros.add_publisher("/t", STRING, LATCHED)
    topic = open_topic(ros, workers, Qos(durability="transient_local", depth=10))
    early = subscription()
    topic.add(early, PLAIN)
    for text in "abc":
        publisher.publish(sample(text).cdr)
    heard = Heard(early)
    await eventually(lambda: heard.texts == ["a", "b", "c"])
    return topic


def join(topic: Topic, **options: Any) -> Subscription:
    late = subscription(**options)
    late.source = Feed(topic.key, PLAIN)
    topic.add(late, PLAIN)
    topic.catch_up(late, PLAIN)
    return late


async def test_a_late_subscriber_gets_what_its_publishers_keep(ros: FakeRos, latched: Topic):
    late = join(latched)
    ros.publish("/t", sample("d").cdr)
    heard = Heard(late)
    await eventually(lambda: len(heard.texts) >= 3)
    assert heard.texts == ["b", "c", "d"]


async def test_a_publisher_that_has_gone_keeps_nothing_for_late_subscribers(
    ros: FakeRos, latched: Topic
):
    ros.remove_publisher(ros.publishers[0])
    other = ros.add_publisher("/t", STRING, LATCHED)
    other.publish(sample("d").cdr)
    heard = Heard(join(latched))
    await eventually(lambda: heard.texts == ["d"])


async def test_retained_samples_have_the_number_of_the_newest(latched: Topic):
    late = join(latched, meta=True)
    frames: list[Any] = []

    def has_come() -> bool:
        wires = late.session.outbox.take(1 << 20)
        frames.extend(frame for wire in wires for frame in unpacked(wire))
        return len(frames) == 2

    await eventually(has_come)
    assert [frame["seq"] for frame in frames] == [3, 3]


async def test_a_late_subscriber_that_leaves_takes_its_reader_with_it(ros: FakeRos, latched: Topic):
    late = join(latched)
    assert len(ros.subscriptions) == 2
    late.source = None
    latched.remove(late, PLAIN)
    assert len(ros.subscriptions) == 1


async def test_the_subscriptions_of_a_topic_end_with_it(ros: FakeRos, latched: Topic):
    join(latched)
    latched.close()
    assert ros.subscriptions == []


async def test_another_encoding_of_the_topic_does_not_restart_the_late_join(
    ros: FakeRos, latched: Topic
):
    late = join(latched)
    fields = EncodingKey(RosbridgeFraming(), "/t", ("data",), None)
    latched.add(late, fields)
    late.source = Feed(latched.key, fields)
    latched.remove(late, PLAIN)
    assert len(ros.subscriptions) == 2
    heard = Heard(late)
    await eventually(lambda: heard.texts == ["b", "c"])


async def test_after_its_late_join_a_subscription_shares_frames(
    ros: FakeRos, latched: Topic, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(late_join, "QUIET_S", 0.02)
    late = join(latched)
    assert not late.shares_frames
    await eventually(lambda: late.shares_frames)
    assert len(ros.subscriptions) == 1
    assert received(late) == ["b", "c"]
    ros.publish("/t", sample("d").cdr)
    heard = Heard(late)
    await eventually(lambda: heard.texts == ["d"])


async def test_a_client_is_warned_if_ros_refuses_the_late_join(
    ros: FakeRos, latched: Topic, monkeypatch: pytest.MonkeyPatch
):
    def refuse(*_: object) -> None:
        raise RosError("internal", "no room")

    monkeypatch.setattr(type(ros.subscriptions[0]), "join_late", refuse)
    late = join(latched)
    ((wire,),) = [late.session.outbox.take(1000)]
    (status,) = unpacked(wire)
    assert status["msg"] == "no room, so messages that /t keeps for late subscribers are missing"
    ros.publish("/t", sample("d").cdr)
    heard = Heard(late)
    await eventually(lambda: heard.texts == ["d"])


def send_broken(topic: Topic, listener: Subscription, length: int = 100) -> list[Any]:
    """Have a string arrive that is shorter than its length. Return what the listener is told."""
    topic._on_samples([Sample(b"\0\1\0\0" + length.to_bytes(4, "little"), 0)])
    batches = [listener.session.outbox.take(1 << 20) for _ in range(2)]
    return [frame for batch in batches for wire in batch for frame in unpacked(wire)]


def test_broken_samples_are_reported_up_to_a_bound(topic: Topic):
    listener = subscription()
    topic.add(listener, PLAIN)
    told = [frame for length in range(100, 200) for frame in send_broken(topic, listener, length)]
    assert {frame["code"] for frame in told} == {"invalid_value"}
    assert len(told) < 20


def test_a_later_subscriber_is_told_of_a_fault_that_lasts(topic: Topic):
    early, late = subscription(), subscription()
    topic.add(early, PLAIN)
    assert send_broken(topic, early)
    assert not send_broken(topic, early)
    topic.add(late, PLAIN)
    topic.catch_up(late, PLAIN)
    assert send_broken(topic, late)


def test_the_rate_of_a_topic_is_that_of_its_newest_samples_and_ends_with_them(
    topic: Topic, monkeypatch: pytest.MonkeyPatch
):
    now_ns = 1000 * SECOND
    monkeypatch.setattr("gateway.core.topics.topic.time.monotonic_ns", lambda: now_ns)
    assert topic.rate_hz(now_ns) == 0
    for gap_ns in [SECOND] * 5 + [SECOND // 10] * RATE_BATCHES:
        now_ns += gap_ns
        topic._on_samples([sample("x")])
    assert topic.rate_hz(now_ns) == pytest.approx(10)
    assert topic.rate_hz(now_ns + SECOND) == pytest.approx(10)
    assert topic.rate_hz(now_ns + SECOND + 1) == 0


def test_a_slow_topic_keeps_its_rate_for_three_periods(
    topic: Topic, monkeypatch: pytest.MonkeyPatch
):
    now_ns = 1000 * SECOND
    monkeypatch.setattr("gateway.core.topics.topic.time.monotonic_ns", lambda: now_ns)
    for _ in range(3):
        now_ns += 2 * SECOND
        topic._on_samples([sample("x")])
    assert topic.rate_hz(now_ns + 6 * SECOND) == pytest.approx(0.5)
    assert topic.rate_hz(now_ns + 6 * SECOND + 1) == 0


async def test_samples_that_dds_lost_are_counted_and_their_numbers_left_out(
    ros: FakeRos, workers: Executor
):
    topic = open_topic(ros, workers, Qos(depth=3))
    told, silent = subscription(meta=True), subscription()
    topic.add(told, PLAIN)
    topic.add(silent, PLAIN)
    publisher = ros.add_publisher("/t", STRING)
    publisher.publish(sample("first").cdr)
    await eventually(lambda: topic.heard_ns)
    for _ in range(10):  # before the loop takes any
        publisher.publish(sample("burst").cdr)
    await eventually(lambda: told.offered == 4)
    wires = told.session.outbox.take(1 << 20)
    frames = [frame for wire in wires for frame in unpacked(wire)]
    assert [(frame["seq"], frame["dropped"]) for frame in frames] == [
        *((1, 7), (9, 7), (10, 7), (11, 7))
    ]
    late = subscription()
    topic.add(late, PLAIN)
    assert (silent.lost, late.lost) == (7, 0)
    assert topic._counts.lost == 7  # of /metrics


class Socket:
    """A socket with room for everything."""

    room_bytes = 1 << 20

    def __init__(self) -> None:
        self.written: list[bytes] = []

    def write(self, frame: bytes) -> None:
        self.written.append(frame)

    def look(self) -> None:
        raise AssertionError


async def test_of_samples_that_come_together_a_client_gets_what_its_queue_keeps(topic: Topic):
    socket = Socket()
    one = subscription(queue_length=1)
    one.session.outbox.connect(lambda _: 0, socket)
    topic.add(one, PLAIN)
    topic._on_samples([sample("a"), sample("b"), sample("c")])
    assert (socket.written, received(one)) == ([], ["c"])
    topic._on_samples([sample("d")])
    assert (len(socket.written), one.delivery.sent) == (1, 2)


async def test_samples_that_come_together_are_one_write_and_in_order(topic: Topic):
    sockets = [Socket() for _ in range(2)]
    for socket in sockets:
        one = subscription()
        one.session.outbox.connect(lambda _: 0, socket)
        topic.add(one, PLAIN)
    topic._on_samples([sample("a"), sample("b"), sample("c")])
    assert [[frame["msg"]["data"] for frame in unpacked(*each.written)] for each in sockets] == [
        ["a", "b", "c"]
    ] * 2


async def test_a_throttled_subscription_gets_the_newest_at_the_end_and_counts_the_others(
    topic: Topic,
):
    throttled = subscription(throttle_ms=500)  # however slow the machine is at four samples
    woken = asyncio.Event()
    throttled.session.wake = woken.set
    topic.add(throttled, PLAIN)
    for text in "abcd":
        topic._on_samples([sample(text)])
    woken.clear()
    await woken.wait()
    assert received(throttled) == ["a", "d"]
    assert throttled.session.outbox.coalesced == 2


def test_messages_that_go_at_once_are_timed_ten_times_a_second(
    topic: Topic, monkeypatch: pytest.MonkeyPatch
):
    one, busy = subscription(), subscription()
    one.session.outbox.write_directly = lambda entry: len(entry.frame())
    now_ns = SECOND
    monkeypatch.setattr(topic_module.time, "monotonic_ns", lambda: now_ns)
    for each in (one, busy):
        topic.add(each, PLAIN)
    for _ in range(100):
        topic._on_samples([sample("x")._replace(received_ns=1)])
        now_ns += SECOND // 100
    assert sum(one.session.latency.observed().counts) == 10
    assert sum(busy.session.latency.observed().counts) == 0


def test_some_of_many_clients_are_timed_at_once_and_all_of_them_in_turn(
    topic: Topic, monkeypatch: pytest.MonkeyPatch
):
    now_ns = SECOND
    monkeypatch.setattr(topic_module.time, "monotonic_ns", lambda: now_ns)
    many = [subscription() for _ in range(2 * TIMED_AT_ONCE + 1)]
    for each in many:
        each.session.outbox.write_directly = lambda entry: len(entry.frame())
        topic.add(each, PLAIN)
    timed = []
    for _ in range(3):
        topic._on_samples([sample("x")._replace(received_ns=1)])
        now_ns += SECOND // 10
        timed.append(sum(sum(each.session.latency.observed().counts) for each in many))
    assert timed == [TIMED_AT_ONCE, 2 * TIMED_AT_ONCE, 3 * TIMED_AT_ONCE]
    assert all(sum(each.session.latency.observed().counts) for each in many)
