# SPDX-License-Identifier: Apache-2.0
"""A closed entity stays until its last messages are heard, and disturbs no other until then."""

import asyncio
from collections.abc import AsyncIterator
from typing import Any

import pytest

from gateway.sources.actions import SUCCEEDED
from gateway.sources.rclpy import RosOptions
from gateway.sources.rclpy.deferred_destruction import DeferredDestruction
from gateway.sources.rclpy.port import RclpyRos
from gateway.sources.source import Qos
from tests.client import eventually
from tests.clock import StoppedClock
from tests.sources.outside import Outside
from tests.sources.test_contract_actions import FIBONACCI, goal, ignore, sequence
from tests.sources.test_contract_services import SET_BOOL, TRIGGER, echo, request, soon

INT32 = "std_msgs/msg/Int32"
STRING = "std_msgs/msg/String"
MAX_DEFERRED = 64
SEVEN = b"\0\1\0\0\7\0\0\0"


@pytest.fixture
async def ros() -> AsyncIterator[RclpyRos]:
    ros = RclpyRos(RosOptions())
    yield ros
    ros.close()


def publishers(ros: RclpyRos, topic: str) -> list[Any]:
    return [each for each in ros._publishers._node.publishers if each.topic_name == topic]


def services(ros: RclpyRos, name: str) -> list[Any]:
    node = ros.services._endpoints.node
    return [each for each in node.services if each.service_name == name]


async def test_a_kept_entity_is_destroyed_half_a_second_later(monkeypatch):
    clock = StoppedClock(monkeypatch)
    deferred = DeferredDestruction(asyncio.get_running_loop())
    destroyed: list[str] = []
    deferred.defer("topic /a", INT32, lambda: destroyed.append("a"))
    await clock.advance(0.49)
    assert destroyed == []
    await clock.advance(0.02)
    assert destroyed == ["a"]


async def test_at_the_end_an_entity_is_destroyed_once_it_may_have_been_heard(monkeypatch):
    happened: list[object] = []
    monkeypatch.setattr("gateway.sources.rclpy.deferred_destruction.time.sleep", happened.append)
    deferred = DeferredDestruction(asyncio.get_running_loop())
    deferred.defer("topic /a", INT32, lambda: happened.append("a"))
    deferred.close()
    deferred.close()
    assert happened == [0.05, "a"]


async def test_an_entity_that_is_used_again_is_not_destroyed() -> None:
    deferred = DeferredDestruction(asyncio.get_running_loop())
    destroyed: list[str] = []
    deferred.cancel(deferred.defer("topic /a", INT32, lambda: destroyed.append("a")))
    deferred.defer("topic /b", INT32, lambda: destroyed.append("b"))
    await eventually(lambda: bool(destroyed))
    deferred.close()
    assert destroyed == ["b"]


async def test_the_oldest_goes_where_too_much_is_kept() -> None:
    deferred = DeferredDestruction(asyncio.get_running_loop())
    destroyed: list[int] = []
    for number in range(MAX_DEFERRED + 2):
        deferred.defer("topic /a", INT32, lambda number=number: destroyed.append(number))
    assert destroyed == [0, 1]
    deferred.close()
    assert destroyed == list(range(MAX_DEFERRED + 2))


async def test_a_publisher_that_has_published_stays_for_a_moment(ros: RclpyRos) -> None:
    publisher = ros.advertise("/a", INT32, Qos(), lambda _: None)
    publisher.publish(SEVEN)
    publisher.close()
    assert ros.entity_count() == 0
    assert len(publishers(ros, "/a")) == 1
    await eventually(lambda: publishers(ros, "/a") == [])


async def test_a_publisher_that_has_said_nothing_goes_at_once(ros: RclpyRos) -> None:
    ros.advertise("/a", INT32, Qos(), lambda _: None).close()
    assert publishers(ros, "/a") == []


async def test_advertising_again_goes_on_with_the_same_publisher(ros: RclpyRos) -> None:
    publisher = ros.advertise("/a", INT32, Qos(), lambda _: None)
    publisher.publish(SEVEN)
    [before] = publishers(ros, "/a")
    publisher.close()
    again = ros.advertise("/a", INT32, Qos(), lambda _: None)
    assert publishers(ros, "/a") == [before]
    again.close()  # without a message
    assert publishers(ros, "/a") == [before]
    await eventually(lambda: publishers(ros, "/a") == [])


@pytest.mark.parametrize("is_read", [False, True])
async def test_another_type_need_not_wait(ros: RclpyRos, is_read: bool) -> None:
    publisher = ros.advertise("/a", INT32, Qos(), lambda _: None)
    publisher.publish(SEVEN)
    publisher.close()
    if is_read:
        ros.subscribe("/a", STRING, Qos(), lambda _: None, lambda _: None)
    else:
        ros.advertise("/a", STRING, Qos(), lambda _: None)
    assert ros.entity_count() == 1


async def test_a_service_answers_those_who_have_not_heard_of_its_end(ros: RclpyRos) -> None:
    service = ros.services.serve("/s", SET_BOOL, echo)
    client = ros.services.client("/s", SET_BOOL)
    await soon(client.call(request(True)))
    service.close()
    assert await soon(client.call(request(True)))
    await eventually(lambda: services(ros, "/s") == [])


async def test_a_service_that_is_provided_again_answers_alone(ros: RclpyRos) -> None:
    service = ros.services.serve("/s", SET_BOOL, echo)
    client = ros.services.client("/s", SET_BOOL)
    await soon(client.call(request(True)))
    service.close()
    ros.services.serve("/s", SET_BOOL, echo)
    assert len(services(ros, "/s")) == 1


async def test_a_service_may_come_back_with_another_type_at_once(ros: RclpyRos) -> None:
    service = ros.services.serve("/s", SET_BOOL, echo)
    client = ros.services.client("/s", SET_BOOL)
    await soon(client.call(request(True)))
    service.close()
    client.close()
    ros.services.serve("/s", TRIGGER, echo)
    assert len(services(ros, "/s")) == 1


async def test_nothing_is_left_when_all_ends() -> None:
    ros = RclpyRos(RosOptions())
    publisher = ros.advertise("/a", INT32, Qos(), lambda _: None)
    publisher.publish(SEVEN)
    node = ros._publishers._node
    ros.close()
    assert list(node.publishers) == []


async def test_the_gateway_sees_the_end_at_once(ros: RclpyRos) -> None:
    service = ros.services.serve("/s", SET_BOOL, echo)
    await soon(ros.services.client("/s", SET_BOOL).call(request(True)))
    action = ros.actions.serve_action(
        "/a", FIBONACCI, lambda goal: goal.finish(SUCCEEDED, sequence()), ignore
    )
    await soon(ros.actions.action_client("/a", FIBONACCI).send_goal(goal(1), ignore))

    def names() -> set[str]:
        return {each.name for each in (*ros.graph().services, *ros.graph().actions)}

    await eventually(lambda: names() >= {"/s", "/a"})
    assert (ros.service_types("/s"), ros.action_types("/a")) == ((SET_BOOL,), (FIBONACCI,))
    service.close()
    action.close()
    assert not names() & {"/s", "/a"}
    assert ros.service_types("/s") == ros.action_types("/a") == ()
    assert len(services(ros, "/s")) == 1


async def test_another_server_of_that_name_is_seen(ros: RclpyRos, outside: Outside) -> None:
    service = ros.services.serve("/s", SET_BOOL, echo)
    await soon(ros.services.client("/s", SET_BOOL).call(request(True)))
    outside.add_service("/s", SET_BOOL, echo)
    await eventually(lambda: [len(s.nodes) for s in ros.graph().services if s.name == "/s"] == [2])
    service.close()
    assert ros.service_types("/s") == (SET_BOOL,)
