# SPDX-License-Identifier: Apache-2.0
"""The contract of the router with ROS: the fake and rclpy."""

import asyncio
import contextlib
import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import pytest

from gateway.config.limits import MAX_QUEUE_DEPTH
from gateway.sources.rclpy import RosOptions, open_ros
from gateway.sources.source import (
    Publisher,
    Qos,
    Ros,
    RosError,
    Sample,
    TopicEvent,
)
from tests.client import eventually, eventually_equal
from tests.sources.conftest import Robot
from tests.sources.fake import FakeRos

pytestmark = pytest.mark.parts("publishing", "diagnosis")
MATCHES_QOS = pytest.mark.parts("publishing", "diagnosis", "qos")  # Zenoh lets all QoS match

STRING = "std_msgs/msg/String"
INT32 = "std_msgs/msg/Int32"
TOPICS = ("/count", "/cmd_vel")  # commands have another participant
LATCHED = Qos(durability="transient_local", depth=5)
BEST_EFFORT = Qos(reliability="best_effort")
BAD_NAMES = [
    *("count", "", "/", "~", "/~", "~/count", "/{node}", "/a//b", "/a/", "/1a", "/a/1b"),
    *("/a b", "/a-b", "/é", "/count\0", "/count\n", "/" + "a" * 300),
]
BAD_TYPES = [
    *("", "x", "std_msgs/Int32", "std_msgs/msg/Int33", "none_msgs/msg/Int32", "std_msgs/srv/Int32"),
    *("std_msgs/msg/Int32\n", "antigravity/msg/Int32", "os/msg/Path", "std_msgs.msg/msg/Int32"),
]


def number(value: int) -> bytes:
    return b"\0\1\0\0" + value.to_bytes(4, "little")


class Received:
    """The messages that a subscription delivered."""

    def __init__(self) -> None:
        self.batches: list[list[Sample]] = []
        self.reasons: list[TopicEvent] = []

    def on_samples(self, samples: Sequence[Sample]) -> None:
        self.batches.append(list(samples))

    def on_event(self, reason: TopicEvent) -> None:
        self.reasons.append(reason)

    @property
    def cdrs(self) -> list[bytes]:
        return [sample.cdr for batch in self.batches for sample in batch]


def subscribe(robot: Robot, topic: str, type_name: str = INT32, qos: Qos | None = None) -> Any:
    received = Received()
    subscription = robot.ros.subscribe(
        topic, type_name, qos or Qos(), received.on_samples, received.on_event
    )
    return received, subscription


def advertise(robot: Robot, topic: str, qos: Qos) -> tuple[list[TopicEvent], Publisher]:
    reasons: list[TopicEvent] = []
    return reasons, robot.ros.publishing.advertise(topic, INT32, qos, reasons.append)


async def until_it_flows(publisher: Publisher, received: Received, first: int = 1_000_000) -> None:
    """Publish until something arrives: a publisher cannot know when its samples begin to."""
    values: Iterator[int] = itertools.count(first)

    def arrived() -> bool:
        publisher.publish(number(next(values)))
        return bool(received.cdrs)

    await eventually(arrived)


async def test_nothing_is_wrong_with_ros_that_runs(robot: Robot) -> None:
    assert list(robot.ros.diagnosis.faults()) == []


async def test_the_newest_samples_win_when_the_loop_falls_behind(robot: Robot) -> None:
    received, _ = subscribe(robot, "/count", qos=Qos(depth=3))
    publisher = robot.world.add_publisher("/count", INT32, Qos(depth=500))
    await until_it_flows(publisher, received)
    for value in range(200):
        publisher.publish(number(value))
    await eventually(lambda: number(199) in received.cdrs)
    assert len(received.cdrs) < 200


async def test_samples_that_newer_ones_replace_are_counted(robot: Robot) -> None:
    received, subscription = subscribe(robot, "/count", qos=Qos(depth=3))
    publisher = robot.world.add_publisher("/count", INT32, Qos(depth=500))
    await until_it_flows(publisher, received)
    publisher.publish(number(777))
    await eventually(lambda: number(777) in received.cdrs)  # and so nothing waits
    lost, taken = subscription.lost, len(received.cdrs)
    for value in range(200):
        publisher.publish(number(value))
    await eventually(lambda: number(199) in received.cdrs)
    assert subscription.lost - lost == 200 - (len(received.cdrs) - taken) > 0


async def test_nothing_is_lost_of_a_burst_that_fits(robot: Robot) -> None:
    received, subscription = subscribe(robot, "/count", qos=Qos(depth=MAX_QUEUE_DEPTH))
    publisher = robot.world.add_publisher("/count", INT32, Qos(depth=MAX_QUEUE_DEPTH))
    await until_it_flows(publisher, received)
    lost = subscription.lost
    for value in range(500):
        publisher.publish(number(value))
    await eventually(lambda: number(499) in received.cdrs)
    assert received.cdrs[-500:] == [number(value) for value in range(500)]
    assert subscription.lost == lost


async def test_a_published_message_reaches_an_outside_subscription(robot: Robot) -> None:
    received = Received()
    robot.world.add_subscription("/command", INT32, received.on_samples)
    await until_it_flows(
        robot.ros.publishing.advertise("/command", INT32, Qos(), lambda _: None), received
    )
    assert int.from_bytes(received.cdrs[0][4:], "little") >= 1_000_000


async def test_the_gateway_hears_itself(robot: Robot) -> None:
    received, _ = subscribe(robot, "/echo")
    await until_it_flows(
        robot.ros.publishing.advertise("/echo", INT32, Qos(), lambda _: None), received
    )


async def test_messages_of_the_gateway_itself_arrive_and_count_as_no_entity(robot: Robot):
    received, _ = subscribe(robot, "/self")
    count = robot.ros.diagnosis.entity_count()
    publisher = robot.ros.publishing.advertise_own("/self", INT32, Qos())
    await until_it_flows(publisher, received)
    assert robot.ros.diagnosis.entity_count() == count
    with pytest.raises(RosError) as error:
        robot.ros.publishing.advertise("/self", STRING, Qos(), lambda _: None)
    assert error.value.code == "type_conflict"
    with pytest.raises(RosError):
        robot.ros.publishing.advertise_own("/self", STRING, Qos())
    publisher.close()
    publisher.close()


async def test_closing_twice_is_harmless(robot: Robot) -> None:
    _, subscription = subscribe(robot, "/count")
    publisher = robot.ros.publishing.advertise("/count", INT32, Qos(), lambda _: None)
    watch = robot.ros.watch_graph(lambda: None)
    for each in (subscription, publisher, watch):
        each.close()
        each.close()
    assert robot.ros.diagnosis.entity_count() == 0


async def test_entities_are_counted_by_handle(robot: Robot) -> None:
    _, subscription = subscribe(robot, "/count")
    publishers = [
        robot.ros.publishing.advertise("/count", INT32, Qos(), lambda _: None) for _ in range(2)
    ]
    assert robot.ros.diagnosis.entity_count() == 3
    publishers[0].close()
    assert robot.ros.diagnosis.entity_count() == 2
    received, _ = subscribe(robot, "/count")
    await until_it_flows(publishers[1], received)  # the other handle did not take it along
    subscription.close()
    publishers[1].close()
    assert robot.ros.diagnosis.entity_count() == 1


def refusals(attempts: list[Callable[[], object]]) -> set[str]:
    """Return the codes with which attempts are refused, ``accepted`` for one that is not."""
    codes = set()
    for attempt in attempts:
        try:
            attempt()
        except RosError as error:
            codes.add(str(error.code))
        else:
            codes.add("accepted")
    return codes


def attempts(robot: Robot, topic: str, type_name: str) -> list[Callable[[], object]]:
    return [
        lambda: subscribe(robot, topic, type_name),
        lambda: robot.ros.publishing.advertise(topic, type_name, Qos(), lambda _: None),
    ]


async def test_a_name_that_is_not_fully_qualified_is_bad(robot: Robot) -> None:
    found = {each: refusals(attempts(robot, each, INT32)) for each in BAD_NAMES}
    assert found == {key: {"bad_name"} for key in BAD_NAMES}
    assert robot.ros.diagnosis.entity_count() == 0


async def test_a_type_without_a_ros_package_is_bad(robot: Robot) -> None:
    found = {each: refusals(attempts(robot, "/count", each)) for each in BAD_TYPES}
    assert found == {key: {"bad_type"} for key in BAD_TYPES}
    assert robot.ros.diagnosis.entity_count() == 0


async def test_a_topic_is_open_with_one_type_at_a_time(robot: Robot) -> None:
    _, subscription = subscribe(robot, "/count", INT32)
    with pytest.raises(RosError, match="open here as std_msgs/msg/Int32") as caught:
        robot.ros.publishing.advertise("/count", STRING, Qos(), lambda _: None)
    assert caught.value.code == "type_conflict"
    with pytest.raises(RosError, match="open here as std_msgs/msg/Int32"):
        subscribe(robot, "/count", STRING)
    subscription.close()
    subscribe(robot, "/count", STRING)


async def test_a_topic_that_was_just_closed_may_have_another_type(robot: Robot) -> None:
    for type_name in (INT32, STRING) * 20:
        _, subscription = subscribe(robot, "/count", type_name)
        await asyncio.sleep(0.005)  # the others also wait for messages
        subscription.close()


async def test_a_later_subscription_gets_the_retained_samples(robot: Robot) -> None:
    publisher = robot.world.add_publisher("/map", INT32, LATCHED)
    for value in range(3):
        publisher.publish(number(value))
    received, subscription = subscribe(robot, "/map")
    await eventually(lambda: len(received.cdrs) >= 3)
    assert received.cdrs[-3:] == [number(0), number(1), number(2)]
    assert subscription.qos.durability == "transient_local"


BRIEF = Qos(durability="transient_local", lifespan_ns=4_000_000_000)


async def test_a_publisher_that_keeps_briefly_reaches_who_asks_for_transient_local(robot):
    received = Received()
    robot.world.add_subscription("/map", INT32, received.on_samples, LATCHED)
    await until_it_flows(advertise(robot, "/map", BRIEF)[1], received)


async def test_briefly_kept_samples_are_nothing_to_adopt(robot: Robot) -> None:
    received, subscription = subscribe(robot, "/map")
    await until_it_flows(robot.world.add_publisher("/map", INT32, BRIEF), received)
    assert subscription.qos.durability == "volatile"
    _, later = subscribe(robot, "/map")
    assert later.qos.durability == "volatile"
    longer = replace(BRIEF, lifespan_ns=3_600_000_000_000)
    robot.world.add_publisher("/plan", INT32, longer)
    _, adopting = subscribe(robot, "/plan")
    await eventually(lambda: adopting.qos.durability == "transient_local")


@MATCHES_QOS
async def test_a_publisher_hears_of_subscriptions_that_get_nothing_once(robot: Robot) -> None:
    reasons, publisher = advertise(robot, "/map", Qos(durability="volatile"))
    subscribe(robot, "/map", qos=LATCHED)  # of the gateway: that one is told itself
    robot.world.add_subscription("/map", INT32, lambda _: None, Qos(durability="volatile"))
    robot.world.add_subscription("/map", INT32, lambda _: None, LATCHED)
    await eventually(lambda: bool(reasons))
    [reason] = reasons
    assert reason.code == "qos_incompatible"
    assert reason.problem == (
        "topic /map: /outside asks for durability transient_local, published is with durability"
        " volatile"
    )
    later, second = advertise(robot, "/map", Qos(durability="volatile"))
    assert later == []  # the caller does not hold the publisher yet
    await eventually(lambda: later == reasons)
    publisher.close()
    second.close()


@pytest.mark.parametrize("topic", TOPICS)
async def test_a_publisher_hears_of_subscriptions_to_another_type(robot: Robot, topic: str) -> None:
    robot.world.add_subscription(topic, STRING, lambda _: None)
    await eventually(lambda: robot.ros.topic_types(topic) == (STRING,))
    reasons, _ = advertise(robot, topic, Qos())
    await eventually(lambda: bool(reasons))
    assert reasons[0].code == "type_conflict"
    assert reasons[0].problem.startswith(
        f"topic {topic}: /outside subscribes to std_msgs/msg/String"
    )


@pytest.mark.parametrize("topic", TOPICS)
async def test_a_subscriber_in_the_place_of_another_has_another_id(robot, topic):
    _, publisher = advertise(robot, topic, Qos())
    assert publisher.new_matches() == 0
    found: list[frozenset[str]] = []
    for _ in range(2):
        subscription = robot.world.add_subscription(topic, INT32, lambda _: None)
        await eventually(lambda: publisher.new_matches() == 1)
        found.append(
            robot.ros.publishing.readers(topic)
        )  # at once: the graph need not have reported it
        assert [len(each) for each in found] == [1] * len(found)
        robot.world.remove_subscription(subscription)
        await eventually(lambda: robot.ros.publishing.readers(topic) == frozenset())
    assert found[0] != found[1]
    assert publisher.new_matches() == 0


@pytest.mark.parametrize("topic", TOPICS)
async def test_the_gateways_own_subscriptions_are_nobody_who_joins(robot, topic):
    _, publisher = advertise(robot, topic, Qos())
    subscribe(robot, topic)
    await eventually(lambda: publisher.new_matches() == 1)
    assert robot.ros.publishing.readers(topic) == frozenset()


@MATCHES_QOS
async def test_no_subscription_is_told_of_after_close(robot: Robot) -> None:
    reasons, publisher = advertise(robot, "/map", Qos(durability="volatile"))
    publisher.close()
    others, _ = advertise(robot, "/map", Qos(durability="volatile"))
    robot.world.add_subscription("/map", INT32, lambda _: None, LATCHED)
    await eventually(lambda: bool(others))
    assert reasons == []


async def test_latched_publishers_keep_what_each_of_them_said_last(robot: Robot) -> None:
    for value in (1, 2):
        robot.ros.publishing.advertise(
            "/map", INT32, replace(LATCHED, depth=1), lambda _: None
        ).publish(number(value))
    late: list[Sample] = []
    robot.world.add_subscription("/map", INT32, late.extend, LATCHED)
    await eventually(lambda: sorted(each.cdr for each in late) == [number(1), number(2)])


async def test_a_late_subscriber_gets_the_messages_that_each_publisher_keeps(robot: Robot) -> None:
    one, other, gone = (robot.world.add_publisher("/map", INT32, LATCHED) for _ in range(3))
    received, subscription = subscribe(robot, "/map", qos=replace(LATCHED, depth=50))
    await eventually(lambda: subscription.publishers == 3)
    for value, publisher in enumerate([*[one] * 7, other, gone]):
        publisher.publish(number(value))
        await eventually(lambda value=value: number(value) in received.cdrs)
    assert len(received.cdrs) == 9
    gone.close()
    await eventually(lambda: subscription.publishers == 2)
    late: list[Sample] = []
    reader = subscription.join_late(late.extend)
    await eventually(lambda: len(late) == 6)
    kept = [number(value) for value in (2, 3, 4, 5, 6)]
    assert [each.cdr for each in late if each.cdr != number(7)] == kept
    await eventually(lambda: reader.publishers == 2)
    early = {each.origin: each.cdr for batch in received.batches for each in batch}
    assert len(early) == 9
    assert all(early[each.origin] == each.cdr for each in late)
    reader.close()
    reader.close()
    one.publish(number(9))
    await eventually(lambda: number(9) in received.cdrs)
    assert len(late) == 6


async def test_an_earlier_subscription_follows_to_transient_local(robot: Robot) -> None:
    received, subscription = subscribe(robot, "/map")
    assert subscription.qos.durability == "volatile"
    robot.world.add_publisher("/map", INT32, LATCHED).publish(number(7))
    await eventually(lambda: subscription.qos.durability == "transient_local")
    await eventually(lambda: number(7) in received.cdrs)


async def test_latched_samples_tell_their_publishers_apart(robot: Robot) -> None:
    for value in (1, 2):
        robot.world.add_publisher("/map", INT32, LATCHED).publish(number(value))
    received, subscription = subscribe(robot, "/map")
    await eventually(lambda: len(received.cdrs) == 2)
    late: list[Sample] = []
    subscription.join_late(late.extend)
    await eventually(lambda: len(late) == 2)
    early = {each.publisher: each.cdr for batch in received.batches for each in batch}
    assert len(early) == 2
    assert None not in early
    assert {each.publisher: each.cdr for each in late} == early


@pytest.mark.parametrize(
    "passing", [Qos(), BEST_EFFORT, replace(LATCHED, reliability="best_effort")]
)
async def test_latched_samples_come_once_while_other_publishers_come_and_go(robot, passing):
    publisher = robot.world.add_publisher("/map", INT32, LATCHED)
    values = itertools.count()
    received, subscription = subscribe(robot, "/map")
    # Over Zenoh, the moment in which both find each other may cost the first messages
    await eventually(lambda: subscription.publishers == 1)

    async def publish_and_see() -> None:
        for _ in range(3):
            publisher.publish(number(next(values)))
        newest = number(next(values))
        publisher.publish(newest)
        await eventually(lambda: newest in received.cdrs)

    await publish_and_see()
    await eventually(lambda: subscription.qos.durability == "transient_local")
    alone = subscription.qos
    for _ in range(2):
        other = robot.world.add_publisher("/map", INT32, passing)
        await eventually(lambda: subscription.qos != alone)
        await publish_and_see()
        other.close()
        await eventually(lambda: subscription.qos == alone)
        await publish_and_see()
    assert received.cdrs == [number(value) for value in range(20)]


async def test_the_first_to_name_the_type_gets_each_latched_sample_once_and_in_order(robot):
    received, subscription = subscribe(robot, "/map", qos=Qos(depth=100))
    publisher = robot.world.add_publisher("/map", INT32, replace(LATCHED, depth=100))
    for value in range(100):
        publisher.publish(number(value))
        await asyncio.sleep(0.001)  # the subscription is discovered and replaced in this time
    await eventually(lambda: number(99) in received.cdrs)
    assert subscription.qos.durability == "transient_local"
    assert received.cdrs == [number(value) for value in range(100)]


async def test_an_earlier_subscription_follows_to_best_effort(robot: Robot) -> None:
    received, subscription = subscribe(robot, "/scan")
    assert subscription.qos.reliability == "reliable"
    publisher = robot.world.add_publisher("/scan", INT32, BEST_EFFORT)
    await until_it_flows(publisher, received)
    assert subscription.qos.reliability == "best_effort"
    assert received.reasons == []


async def test_the_weaker_offer_decides_until_it_goes(robot: Robot) -> None:
    received, subscription = subscribe(robot, "/scan")
    reliable = robot.world.add_publisher("/scan", INT32)
    weaker = robot.world.add_publisher("/scan", INT32, BEST_EFFORT)
    await eventually(lambda: subscription.qos.reliability == "best_effort")
    await until_it_flows(weaker, received)
    weaker.close()
    await eventually(lambda: subscription.qos.reliability == "reliable")
    received.batches.clear()
    await until_it_flows(reliable, received)


async def test_the_profile_stays_when_the_last_publisher_goes(robot: Robot) -> None:
    _, subscription = subscribe(robot, "/scan")
    publisher = robot.world.add_publisher("/scan", INT32, BEST_EFFORT)
    await eventually(lambda: subscription.qos.reliability == "best_effort")
    publisher.close()
    await eventually(lambda: not nodes_publishing(robot, "/scan"))
    assert subscription.qos.reliability == "best_effort"


async def test_a_subscription_has_what_each_publisher_offers(robot: Robot) -> None:
    _, subscription = subscribe(robot, "/count")
    _, of_another_type = subscribe(robot, "/text")
    assert list(subscription.offers) == []
    profiles = [
        Qos("reliable", "transient_local", deadline_ns=2_000_000_000, lifespan_ns=9_000_000_000),
        Qos("best_effort", "volatile"),
    ]
    for qos in profiles:
        robot.world.add_publisher("/count", INT32, qos)
    robot.world.add_publisher("/text", STRING)
    await eventually(lambda: len(subscription.offers) == 2)
    await eventually(lambda: bool(nodes_publishing(robot, "/text")))
    assert list(of_another_type.offers) == []
    offers = [replace(each, depth=None, history=None) for each in subscription.offers]
    assert sorted(offers, key=str) == sorted(profiles, key=str)


@MATCHES_QOS
async def test_an_offer_that_cannot_match_is_told_once_in_words(robot: Robot) -> None:
    received, subscription = subscribe(robot, "/scan", qos=Qos(reliability="reliable"))
    publisher = robot.world.add_publisher("/scan", INT32, BEST_EFFORT)
    await eventually(lambda: bool(received.reasons))
    [reason] = received.reasons
    assert reason.code == "qos_incompatible"
    assert reason.text == (
        "topic /scan: /outside offers reliability best_effort, the subscription asks for"
        " reliability reliable; ask for best_effort or leave the reliability open"
    )
    other = robot.world.add_publisher("/scan", INT32, Qos())
    await until_it_flows(other, received)
    publisher.publish(number(1))
    assert len(received.reasons) == 1
    assert subscription.qos.reliability == "reliable"


@MATCHES_QOS
async def test_an_offer_that_stands_already_is_told_after_subscribing(robot: Robot) -> None:
    robot.world.add_publisher("/map", INT32)
    await eventually_equal(lambda: nodes_publishing(robot, "/map"), ("/outside",))
    received, _ = subscribe(robot, "/map", qos=Qos(durability="transient_local"))
    assert received.reasons == []  # the caller does not hold the subscription yet
    await eventually(lambda: bool(received.reasons))
    assert "durability volatile" in received.reasons[0].text


async def test_a_publisher_of_another_type_is_told_in_words(robot: Robot) -> None:
    received, _ = subscribe(robot, "/count", INT32)
    robot.world.add_publisher("/count", STRING)
    await eventually(lambda: bool(received.reasons))
    [reason] = received.reasons
    assert reason.code == "type_conflict"
    assert reason.text == (
        "topic /count: /outside publishes std_msgs/msg/String, the subscription is for"
        " std_msgs/msg/Int32; subscribe with the type std_msgs/msg/String"
    )


async def test_publishers_that_go_are_told_of_by_their_nodes(robot: Robot) -> None:
    received, subscription = subscribe(robot, "/count")
    seen: list[tuple[str, ...]] = []
    robot.ros.watch_graph(lambda: seen.append(nodes_publishing(robot, "/count")))
    first, second = (robot.world.add_publisher("/count", INT32) for _ in range(2))
    await eventually(lambda: ("/outside", "/outside") in seen)
    # the subscription looks before each report, which may show what came in between: by the next
    # report it has seen both
    reports = len(seen)
    robot.world.add_publisher("/other", INT32)
    await eventually(lambda: len(seen) > reports)
    for publisher, text in ((first, "others do"), (second, "nobody does")):
        publisher.close()
        gone = ("publisher_gone", f"topic /count: /outside publishes no longer, {text}")
        await eventually(
            lambda gone=gone: gone in [(each.code, each.text) for each in received.reasons]
        )
    subscription.close()


async def test_the_publishers_that_match_a_subscription_are_counted(robot: Robot) -> None:
    _, subscription = subscribe(robot, "/map")
    assert subscription.publishers == 0
    first = robot.world.add_publisher("/map", INT32, LATCHED)
    robot.world.add_publisher("/map", INT32, LATCHED)
    await eventually(lambda: subscription.publishers == 2)
    first.close()
    await eventually(lambda: subscription.publishers == 1)
    robot.world.add_publisher("/map", INT32, replace(LATCHED, durability="volatile"))
    _, later = subscribe(robot, "/map", qos=LATCHED)
    await eventually(lambda: later.publishers == 1)


async def test_a_subscription_that_keeps_all_is_bounded(robot: Robot) -> None:
    _, subscription = subscribe(robot, "/count", qos=Qos(history="keep_all"))
    assert subscription.qos == Qos("reliable", "volatile", "keep_last", MAX_QUEUE_DEPTH)


async def test_the_types_of_a_topic_appear_and_vanish_with_it(robot: Robot) -> None:
    assert robot.ros.topic_types("/count") == ()
    publisher = robot.world.add_publisher("/count", INT32)
    await eventually(lambda: robot.ros.topic_types("/count") == (INT32,))
    publisher.close()
    await eventually(lambda: robot.ros.topic_types("/count") == ())


@pytest.mark.parametrize("topic", TOPICS)
async def test_the_type_of_an_own_new_publisher_is_known_at_once(robot: Robot, topic: str) -> None:
    robot.world.add_subscription(topic, INT32, lambda _: None)
    await eventually(lambda: robot.ros.topic_types(topic) == (INT32,))
    robot.ros.publishing.advertise(topic, STRING, Qos(), lambda _: None)
    assert robot.ros.topic_types(topic) == (STRING,)


@pytest.mark.parametrize("topic", TOPICS)
async def test_the_graph_lists_endpoints_by_node_our_own_included(robot: Robot, topic: str) -> None:
    robot.world.add_publisher(topic, INT32)
    robot.world.add_publisher(topic, INT32)
    robot.ros.publishing.advertise(topic, INT32, Qos(), lambda _: None)
    subscribe(robot, topic)
    publishing = ("/outside", "/outside", "/ros2_gateway_publishers")
    await eventually_equal(lambda: nodes_publishing(robot, topic), publishing)
    info = next(t for t in robot.ros.graph().topics if t.name == topic)
    assert info.types == (INT32,)
    assert info.subscribers == ("/ros2_gateway_subscriptions",)
    ours = ("debug", "publishers", "services", "subscriptions")
    expected = ("/outside", *(f"/ros2_gateway_{each}" for each in ours))
    await eventually_equal(lambda: robot.ros.graph().nodes, expected)


async def test_the_graph_shows_whether_a_topic_keeps_messages(robot: Robot) -> None:
    def kept(topic: str) -> list[bool]:
        return [each.is_latched for each in robot.ros.graph().topics if each.name == topic]

    robot.world.add_publisher("/kept", INT32, Qos("reliable", "transient_local", depth=1))
    robot.world.add_publisher("/count", INT32)
    await eventually_equal(lambda: (kept("/kept"), kept("/count")), ([True], [False]))
    robot.world.add_publisher("/kept", INT32)
    await eventually_equal(lambda: kept("/kept"), [False])


async def test_a_watch_hears_of_publishers_that_come_and_go(robot: Robot) -> None:
    seen: list[tuple[str, ...]] = []
    watch = robot.ros.watch_graph(lambda: seen.append(nodes_publishing(robot, "/count")))
    publisher = robot.world.add_publisher("/count", INT32)
    await eventually(lambda: ("/outside",) in seen)
    publisher.close()
    await eventually(lambda: seen[-1] == ())
    watch.close()
    heard = len(seen)
    other: list[None] = []
    robot.ros.watch_graph(lambda: other.append(None))
    robot.world.add_publisher("/count", INT32)
    await eventually(lambda: bool(other))
    assert len(seen) == heard


async def test_a_watch_that_an_earlier_one_closes_hears_nothing(robot: Robot) -> None:
    heard: list[str] = []

    def on_change() -> None:
        heard.append("first")
        second.close()

    robot.ros.watch_graph(on_change)
    second = robot.ros.watch_graph(lambda: heard.append("second"))
    robot.world.add_publisher("/count", INT32)
    await eventually(lambda: bool(heard))
    assert "second" not in heard


async def test_changes_close_together_are_one_call(robot: Robot) -> None:
    calls: list[int] = []
    robot.world.add_publisher("/first", INT32)
    await eventually_equal(lambda: nodes_publishing(robot, "/first"), ("/outside",))
    robot.ros.watch_graph(lambda: calls.append(len(robot.ros.graph().topics)))
    for index in range(20):
        robot.ros.publishing.advertise(f"/of_ours/n{index}", INT32, Qos(), lambda _: None)
    await eventually(lambda: len(nodes_publishing(robot, "/of_ours/n19")) == 1)
    await eventually(lambda: bool(calls))
    assert len(calls) < 20


def nodes_publishing(robot: Robot, topic: str) -> tuple[str, ...]:
    return next((t.publishers for t in robot.ros.graph().topics if t.name == topic), ())


@pytest.mark.parametrize("kind", ["fake", "real"])
async def test_some_entities_are_kept_for_publishers_of_reserved_topics(kind: str) -> None:
    options = RosOptions(max_entities=8, reserved_entities=2, reserved_topics=("/drive", "/arm"))
    async with contextlib.AsyncExitStack() as stack:
        ros: Ros = FakeRos(options=options)
        if kind == "real":
            ros = await stack.enter_async_context(open_ros(options))
        others = [
            ros.publishing.advertise(f"/t{number}", INT32, Qos(), lambda _: None)
            for number in range(6)
        ]
        text = "at most 8 ROS entities, of which 2 are kept for command topics"
        attempts: list[Callable[[], object]] = [
            lambda: ros.publishing.advertise("/more", INT32, Qos(), lambda _: None),
            lambda: ros.subscribe("/drive", INT32, Qos(), print, print),
            lambda: ros.services.client("/drive", "std_srvs/srv/Trigger"),
        ]
        for attempt in attempts:
            with pytest.raises(RosError, match=text) as caught:
                attempt()
            assert caught.value.code == "limit_exceeded"
        kept = [
            ros.publishing.advertise(topic, INT32, Qos(), lambda _: None)
            for topic in ("/drive", "/arm")
        ]
        with pytest.raises(RosError, match="at most 8 ROS entities"):
            ros.publishing.advertise("/drive", INT32, Qos(), lambda _: None)
        for each in (*others, *kept):
            each.close()


async def test_nodes_of_different_names_share_none(robot: Robot) -> None:
    robot.world.add_publisher("/anything", INT32)
    await eventually(lambda: "/outside" in robot.ros.graph().nodes)
    assert robot.ros.diagnosis.shared_names() == ()


async def test_a_source_says_where_it_searches_for_nodes(robot: Robot) -> None:
    assert set(robot.ros.network) == {"domain_id", "rmw", "discovery"}
