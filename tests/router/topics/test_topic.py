# SPDX-License-Identifier: Apache-2.0
"""One topic by itself, over the fake ROS."""

import asyncio
from collections.abc import Iterator
from concurrent.futures import Executor, ThreadPoolExecutor
from typing import Any

import pytest

from gateway.codec.types import MessageType, Types
from gateway.config.limits import Limits
from gateway.ports import Qos, RosError, Sample
from gateway.protocol.names import TopicName
from gateway.protocol.operations.topics import Subscribe
from gateway.protocol.session import Session
from gateway.protocol.subscription_options import SubscriptionOptions
from gateway.router.topic_counts import TopicCounts
from gateway.router.topics import topic as topic_module
from gateway.router.topics.subscription import EncodingKey, Subscription, TopicKey
from gateway.router.topics.topic import Topic
from schemas.installed import InstalledDefinitions
from tests.client import eventually
from tests.ros.fake import FakeRos
from tests.wire import unpacked

SECOND = 1_000_000_000
STRING = "std_msgs/msg/String"
TYPES = Types(InstalledDefinitions())
NAME = TopicName("/t")
PLAIN = EncodingKey("/t", None, None)

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


def open_topic(ros: FakeRos, workers: Executor, qos: Qos | None = None) -> Topic:
    return Topic(TopicKey(NAME, STRING, qos or Qos()), string_type(), ros, workers, TopicCounts())


def string_type() -> MessageType:
    return TYPES.get(STRING)


def subscription(**options: Any) -> Subscription:
    request = Subscribe(topic="/t", **options)
    session = Session(Limits(), lambda: None)
    merged = SubscriptionOptions.merge([request])
    return Subscription(session, "/t", NAME, {None: request}, merged, TopicCounts())


def sample(text: str) -> Sample:
    message_type = string_type()
    return Sample(message_type.encode({"data": text}, now_ns=0), 0)


def received(of: Subscription) -> list[Any]:
    frames = [frame for wire in of.session.outbox.take(1 << 20) for frame in unpacked(wire)]
    return [frame["msg"]["data"] for frame in frames if frame["op"] == "publish"]


def test_subscriptions_with_one_encoding_share_the_bytes(topic: Topic):
    one, other = subscription(), subscription()
    for each in (one, other):
        topic.add(each, PLAIN)
    topic._on_samples([sample("x")])
    assert one.session.outbox.take(1000)[0] is other.session.outbox.take(1000)[0]


def test_a_topic_is_idle_until_its_first_and_after_its_last_subscription(topic: Topic):
    assert topic.is_idle
    one, other = subscription(), subscription()
    topic.add(one, PLAIN)
    topic.add(other, EncodingKey("/t", ("data",), None))
    topic.remove(one, PLAIN)
    assert not topic.is_idle
    topic.remove(other, EncodingKey("/t", ("data",), None))
    assert topic.is_idle


def test_a_subscription_that_was_removed_gets_nothing(topic: Topic):
    one, other = subscription(), subscription()
    for each in (one, other):
        topic.add(each, PLAIN)
    topic.remove(one, PLAIN)
    topic._on_samples([sample("x")])
    assert (received(one), received(other)) == ([], ["x"])


def test_what_ros_refuses_is_no_topic(ros: FakeRos, workers: Executor):
    with pytest.raises(RosError):
        Topic(
            TopicKey(NAME, "none_msgs/msg/None", Qos()), string_type(), ros, workers, TopicCounts()
        )


def test_a_late_subscriber_gets_as_many_samples_as_there_are_publishers(
    ros: FakeRos, workers: Executor
):
    latched = Qos(durability="transient_local", depth=1)
    for _ in range(2):
        ros.add_publisher("/t", STRING, latched)
    topic = open_topic(ros, workers, latched)
    topic._on_samples([sample(text) for text in "abcde"])
    late = subscription()
    topic.add(late, PLAIN)
    topic.replay(late, PLAIN)
    assert received(late) == ["d", "e"]


def test_twice_what_is_replayed_is_retained_and_no_more(ros: FakeRos, workers: Executor):
    # a new publisher's sample may come before its discovery
    latched = Qos(durability="transient_local", depth=1)
    ros.add_publisher("/t", STRING, latched)
    topic = open_topic(ros, workers, latched)
    topic._on_samples([sample(text) for text in "abc"])
    assert [seq for seq, _ in topic._latch.newest(100)] == [2, 3]


async def test_a_topic_that_becomes_volatile_retains_nothing(ros: FakeRos, workers: Executor):
    latched = Qos(durability="transient_local", depth=1)
    publisher = ros.add_publisher("/t", STRING, latched)
    topic = open_topic(ros, workers, Qos())
    topic._on_samples([sample("old")])
    ros.remove_publisher(publisher)
    ros.add_publisher("/t", STRING)
    await eventually(lambda: topic._ros_subscription.qos.durability == "volatile")
    topic._on_samples([sample("new")])
    assert topic._latch.newest(100) == []


def send_broken(topic: Topic, listener: Subscription, length: int = 100) -> list[Any]:
    """Have a string arrive that is shorter than its length; return what the listener is told."""
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
    topic.replay(late, PLAIN)
    assert send_broken(topic, late)


def test_the_rate_of_a_topic_is_that_of_its_newest_samples_and_ends_with_them(
    topic: Topic, monkeypatch: pytest.MonkeyPatch
):
    now_ns = 1000 * SECOND
    monkeypatch.setattr("gateway.router.topics.topic.time.monotonic_ns", lambda: now_ns)
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
    monkeypatch.setattr("gateway.router.topics.topic.time.monotonic_ns", lambda: now_ns)
    for _ in range(3):
        now_ns += 2 * SECOND
        topic._on_samples([sample("x")])
    assert topic.rate_hz(now_ns + 6 * SECOND) == pytest.approx(0.5)
    assert topic.rate_hz(now_ns + 6 * SECOND + 1) == 0


async def test_a_throttled_subscription_gets_the_newest_at_the_end_and_counts_the_others(
    topic: Topic,
):
    throttled = subscription(throttle_rate=500)  # however slow the machine is at four samples
    woken = asyncio.Event()
    throttled.session.wake = woken.set
    topic.add(throttled, PLAIN)
    for text in "abcd":
        topic._on_samples([sample(text)])
    woken.clear()
    await woken.wait()
    assert received(throttled) == ["a", "d"]
    assert throttled.session.outbox.coalesced == 2


def test_what_goes_at_once_is_timed_ten_times_a_second(
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
