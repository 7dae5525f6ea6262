# SPDX-License-Identifier: Apache-2.0
"""The contract of the part that every source has: topics, graph, and clock."""

import asyncio
import contextlib
from collections.abc import Sequence

import pytest

from gateway.sources.source import MAX_TAKES_PER_TURN, Qos, RosError, Sample
from schemas.definition_text import parse_definition
from schemas.type_hash import individual_description
from tests.client import TIMEOUT_S, eventually
from tests.sources.conftest import Robot
from tests.sources.test_contract import INT32, number, subscribe, until_it_flows

pytestmark = pytest.mark.parts()


async def test_samples_of_an_outside_publisher_arrive_in_order_and_unchanged(robot: Robot) -> None:
    received, _ = subscribe(robot, "/count")
    publisher = robot.world.add_publisher("/count", INT32)
    await until_it_flows(publisher, received)
    for value in range(20):
        publisher.publish(number(value))
    await eventually(lambda: number(19) in received.cdrs)
    assert received.cdrs[-20:] == [number(value) for value in range(20)]


async def test_a_sample_has_the_time_of_its_reception(robot: Robot) -> None:
    received, _ = subscribe(robot, "/count")
    now_ns = getattr(robot.world, "system_ns", robot.ros.now_ns)
    before = now_ns()
    await until_it_flows(robot.world.add_publisher("/count", INT32), received)
    after = now_ns()
    assert before <= received.batches[0][0].received_ns <= after


async def test_a_batch_is_never_empty_nor_larger_than_a_turn_may_take(robot: Robot) -> None:
    received, _ = subscribe(robot, "/count", qos=Qos(depth=500))
    publisher = robot.world.add_publisher("/count", INT32, Qos(depth=500))
    await until_it_flows(publisher, received)
    for value in range(200):
        publisher.publish(number(value))
    await eventually(lambda: number(199) in received.cdrs)
    assert received.cdrs[-200:] == [number(value) for value in range(200)]
    assert all(1 <= len(batch) <= MAX_TAKES_PER_TURN for batch in received.batches)


async def test_no_sample_comes_after_close(robot: Robot) -> None:
    received, subscription = subscribe(robot, "/count")
    others, _ = subscribe(robot, "/count")
    publisher = robot.world.add_publisher("/count", INT32)
    await until_it_flows(publisher, received)
    await until_it_flows(publisher, others)
    publisher.publish(number(1))
    subscription.close()
    seen = len(received.cdrs)
    publisher.publish(number(2))
    await eventually(lambda: number(2) in others.cdrs)
    assert len(received.cdrs) == seen


async def test_a_subscription_may_be_closed_by_its_callback_and_twice(robot: Robot) -> None:
    seen: list[Sample] = []

    def on_samples(samples: Sequence[Sample]) -> None:
        seen.extend(samples)
        subscription.close()
        subscription.close()

    subscription = robot.ros.subscribe("/count", INT32, Qos(), on_samples, lambda _: None)
    publisher = robot.world.add_publisher("/count", INT32)
    others, _ = subscribe(robot, "/count")

    def is_over() -> bool:
        publisher.publish(number(1))
        return bool(seen) and len(others.cdrs) > len(seen)

    await eventually(is_over)


async def test_a_topic_of_the_world_is_in_the_graph_with_its_type(robot: Robot) -> None:
    robot.world.add_publisher("/count", INT32)
    await eventually(lambda: robot.ros.topic_types("/count") == (INT32,))
    await eventually(lambda: list(robot.ros.topics().get("/count", ())) == [INT32])

    def is_published() -> bool:
        graph = robot.ros.graph()
        found = [each for each in graph.topics if (each.name, each.types) == ("/count", (INT32,))]
        return len(found) == 1 and len(set(found[0].publishers) & set(graph.nodes)) == 1

    await eventually(is_published)


async def test_the_profile_of_a_subscription_has_nothing_left_to_adopt(robot: Robot) -> None:
    _, subscription = subscribe(robot, "/count")
    qos = subscription.qos
    assert None not in (qos.reliability, qos.durability, qos.history, qos.depth)


async def test_an_unknown_name_has_no_type(robot: Robot) -> None:
    for types in (robot.ros.topic_types, robot.ros.service_types, robot.ros.action_types):
        assert types("/nothing") == ()
    assert await robot.ros.definitions("no_msgs/msg/Nothing") is None


async def test_a_definition_is_had_of_the_source_wherever_it_has_it_from(robot: Robot) -> None:
    name, text = "far_msgs/msg/Lamp", "bool on\nfloat32[2] power\n"
    robot.world.add_described_publisher("/lamp", name, text)
    await eventually(lambda: robot.ros.topic_types("/lamp") == (name,))
    asked_until_s = asyncio.get_running_loop().time() + TIMEOUT_S
    found = None
    while found is None and asyncio.get_running_loop().time() < asked_until_s:
        with contextlib.suppress(RosError):  # the node may not have introduced itself yet
            found = await robot.ros.definitions(name)
        await asyncio.sleep(0.05)
    assert found is not None
    expected = parse_definition(name, text)
    assert individual_description(found[name]) == individual_description(expected)


async def test_watches_are_closed_twice_without_harm(robot: Robot) -> None:
    for watch in (robot.ros.watch_graph, robot.ros.watch_jumps_back):
        watching = watch(lambda: None)
        watching.close()
        watching.close()
