# SPDX-License-Identifier: Apache-2.0
"""Quality of service as the robot and the clients see it: a gateway's process, rclpy outside."""

import asyncio
import itertools
from collections.abc import AsyncIterator, Callable, Coroutine, Iterator
from typing import Any

import pytest
import pytest_asyncio
from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

from tests.client import TIMEOUT_S, Client, Frame, client, eventually
from tests.gateway_process import GatewayProcess, gateway_process
from tests.sources.conftest import needs_qos
from tests.sources.outside import Outside

pytestmark = [pytest.mark.asyncio(loop_scope="module"), needs_qos]

RELIABLE, BEST_EFFORT = ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT
LATCHED, VOLATILE = DurabilityPolicy.TRANSIENT_LOCAL, DurabilityPolicy.VOLATILE
STRING = "std_msgs/msg/String"

numbers = itertools.count(1)


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def gateway() -> AsyncIterator[GatewayProcess]:
    async with gateway_process() as gateway:
        yield gateway


@pytest_asyncio.fixture(loop_scope="module")
async def speaker(gateway: GatewayProcess) -> AsyncIterator[Client]:
    async with client(gateway.url) as speaker:
        yield speaker


@pytest.fixture(scope="module")
def outside() -> Iterator[Outside]:
    outside = Outside()
    yield outside
    outside.close()


@pytest.fixture
def topic() -> str:
    return f"/qos_{next(numbers)}"


class Robot:
    """Publishers and subscriptions on one topic, by plain rclpy."""

    def __init__(self, outside: Outside, topic: str) -> None:
        self._node = outside.node
        self._topic = topic

    def publisher(self, qos: QoSProfile | int = 10, type_: type = String) -> Any:
        return self._node.create_publisher(type_, self._topic, qos)

    def remove(self, publisher: Any) -> None:
        self._node.destroy_publisher(publisher)

    def listen(self, qos: QoSProfile) -> list[str]:
        heard: list[str] = []

        def hear(message: Any) -> None:
            heard.append(message.data)

        self._node.create_subscription(String, self._topic, hear, qos)
        return heard

    async def offered(self) -> QoSProfile:
        """Return the profile of the gateway's publisher, once discovery knows it."""
        return await self._only(self._node.get_publishers_info_by_topic)

    async def asked(self) -> QoSProfile:
        """Return the profile of the gateway's subscription, once discovery knows it."""
        return await self._only(self._node.get_subscriptions_info_by_topic)

    async def _only(self, endpoints: Callable[[str], list[Any]]) -> QoSProfile:
        def profiles() -> list[QoSProfile]:
            found = endpoints(self._topic)
            return [each.qos_profile for each in found if each.node_name != self._node.get_name()]

        await eventually(lambda: len(profiles()) == 1)
        return profiles()[0]


@pytest.fixture
def robot(outside: Outside, topic: str) -> Robot:
    return Robot(outside, topic)


async def while_publishing(publish: Callable[[], None], wait: Coroutine[Any, Any, Any]) -> Any:
    """Publish again and again until what is waited for is there."""
    task = asyncio.get_running_loop().create_task(wait)
    while not task.done():
        publish()
        await asyncio.wait([task], timeout=0.05)
    return task.result()


async def texts(speaker: Client, topic: str, count: int) -> list[str]:
    return [(await speaker.message(topic))["data"] for _ in range(count)]


async def publishers(speaker: Client, topic: str) -> int:
    """Return how many publishers of a topic the gateway knows."""
    await speaker.send(op="graph")
    (graph,) = (frame for frame in await speaker.sync() if frame["op"] == "graph")
    return next(len(each["publishers"]) for each in graph["topics"] if each["name"] == topic)


def is_warning(frame: Frame) -> bool:
    return frame["op"] == "status" and frame.get("code") == "qos_incompatible"


async def until_data(speaker: Client, topic: str, data: str | int) -> None:
    while (await speaker.message(topic))["data"] != data:
        pass


async def test_a_subscription_adopts_what_its_publishers_offer(
    speaker: Client, robot: Robot, topic: str
):
    publisher = robot.publisher(QoSProfile(depth=5, reliability=BEST_EFFORT))
    await speaker.send(op="subscribe", topic=topic, type=STRING)
    await while_publishing(
        lambda: publisher.publish(String(data="x")), until_data(speaker, topic, "x")
    )
    assert (await robot.asked()).reliability == BEST_EFFORT


async def test_a_publisher_that_returns_with_a_weaker_offer_is_followed(
    speaker: Client, robot: Robot, topic: str
):
    publisher = robot.publisher(QoSProfile(depth=5, durability=LATCHED))
    await speaker.send(op="subscribe", topic=topic)
    await while_publishing(
        lambda: publisher.publish(String(data="1")), until_data(speaker, topic, "1")
    )
    assert (await robot.asked()).durability == LATCHED
    robot.remove(publisher)
    publisher = robot.publisher(QoSProfile(depth=5, reliability=BEST_EFFORT))
    await while_publishing(
        lambda: publisher.publish(String(data="2")), until_data(speaker, topic, "2")
    )
    asked = await robot.asked()
    assert (asked.reliability, asked.durability) == (BEST_EFFORT, VOLATILE)


async def test_late_clients_get_what_a_late_node_of_ros_gets(
    gateway: GatewayProcess, robot: Robot, topic: str
):
    def publish(publisher: Any, *data: str) -> None:
        for each in data:
            publisher.publish(String(data=each))

    short_lived = QoSProfile(depth=5, durability=LATCHED, lifespan=Duration(seconds=0.1))
    one, two = (robot.publisher(QoSProfile(depth=each, durability=LATCHED)) for each in (1, 3))
    gone = robot.publisher(QoSProfile(depth=1, durability=LATCHED))
    forgetful = robot.publisher(short_lived)
    async with client(gateway.url) as early:
        await early.send(
            op="subscribe", topic=topic, type=STRING, qos={"durability": "transient_local"}
        )
        await eventually(
            lambda: all(p.get_subscription_count() for p in (one, two, gone, forgetful))
        )
        publish(one, *"ABC")
        publish(two, *"DEFGH")
        publish(gone, "of one that leaves")
        publish(forgetful, "for a moment")
        heard: set[str] = set()
        while not heard >= {"C", "H", "of one that leaves"}:  # of a small depth DDS may skip some
            heard |= {*await texts(early, topic, 1)}
        robot.remove(gone)
        async with asyncio.timeout(TIMEOUT_S):
            while await publishers(early, topic) > 3:
                pass
        await asyncio.sleep(0.2)  # longer than the lifespan
        late_node = robot.listen(QoSProfile(depth=10, durability=LATCHED))
        await eventually(lambda: sorted(late_node) == [*"CFGH"])
        for asked in ({}, {"qos": {"durability": "transient_local"}}, {}):
            async with client(gateway.url) as late:
                await late.send(op="subscribe", topic=topic, **asked)
                assert sorted(await texts(late, topic, 4)) == [*"CFGH"]
                publish(one, "new")
                assert await texts(late, topic, 1) == ["new"]
                publish(one, "C")
                assert await texts(late, topic, 1) == ["C"]
                assert await late.sync() == []


async def test_an_explicit_profile_is_the_one_that_ros_sees(
    speaker: Client, robot: Robot, topic: str
):
    await speaker.send(
        op="subscribe",
        topic=topic,
        type=STRING,
        qos={
            "reliability": "best_effort",
            "durability": "transient_local",
            "depth": 3,
            "deadline": 0.5,
            "lifespan": {"secs": 2},
        },
    )
    asked = await robot.asked()
    assert (asked.reliability, asked.durability) == (BEST_EFFORT, LATCHED)
    assert asked.deadline == Duration(seconds=0.5)


async def test_an_explicit_offer_is_the_one_that_ros_sees(
    speaker: Client, robot: Robot, topic: str
):
    await speaker.send(
        op="advertise",
        topic=topic,
        type=STRING,
        qos={
            "reliability": "best_effort",
            "durability": "transient_local",
            "depth": 3,
            "deadline": 0.5,
            "lifespan": {"secs": 2, "nsecs": 500_000_000},
        },
    )
    offered = await robot.offered()
    assert (offered.reliability, offered.durability) == (BEST_EFFORT, LATCHED)
    assert offered.deadline == Duration(seconds=0.5)
    assert offered.lifespan == Duration(seconds=2.5)


async def test_an_offer_without_wishes_is_that_of_rosbridge_except_for_the_end_of_bursts(
    speaker: Client, robot: Robot, topic: str
):
    await speaker.send(op="advertise", topic=topic, type=STRING)
    offered = await robot.offered()
    assert (offered.reliability, offered.durability) == (RELIABLE, LATCHED)
    assert offered.lifespan == Duration(seconds=4)


async def test_a_node_that_insists_on_transient_local_hears_a_client(
    speaker: Client, robot: Robot, topic: str
):
    heard = robot.listen(QoSProfile(depth=1, durability=LATCHED))
    async with asyncio.timeout(TIMEOUT_S):
        while not heard:
            await speaker.send(op="publish", topic=topic, type=STRING, msg={"data": "x"})
            await asyncio.sleep(0.05)


async def test_a_listener_from_before_the_first_publish_gets_each_message_once(
    gateway: GatewayProcess, speaker: Client, topic: str
):
    async with client(gateway.url) as listener:
        await listener.send(op="subscribe", topic=topic, type=STRING)
        await listener.sync()
        for number in range(20):  # long enough for a subscription that adopts anything
            text = str(number)
            await speaker.send(op="publish", topic=topic, type=STRING, msg={"data": text})
            assert await texts(listener, topic, 1) == [text]
            await asyncio.sleep(0.02)


async def test_a_publisher_that_a_node_does_not_match_is_told(
    speaker: Client, robot: Robot, topic: str
):
    qos = {"durability": "volatile"}
    await speaker.send(op="advertise", id=8, topic=topic, type=STRING, qos=qos)
    robot.listen(QoSProfile(depth=1, durability=LATCHED))
    status = await speaker.receive(is_warning)
    assert (status["level"], status["id"], status["request"]) == ("warning", 8, "advertise")
    assert status["msg"] == (
        f"topic {topic}: /outside asks for durability transient_local, published is with durability"
        " volatile; offer transient_local or leave the durability open"
    )


async def test_a_latched_topic_keeps_its_last_message_for_later(
    speaker: Client, robot: Robot, topic: str
):
    await speaker.send(op="advertise", topic=topic, type=STRING, latch=True)
    for text in ("1", "2"):
        await speaker.send(op="publish", topic=topic, msg={"data": text})
    await speaker.sync()
    heard = robot.listen(QoSProfile(depth=9, durability=LATCHED))
    await eventually(lambda: bool(heard))
    assert heard == ["2"]


async def test_a_depth_is_how_many_messages_are_kept_for_later(
    speaker: Client, robot: Robot, topic: str
):
    qos = {"durability": "transient_local", "depth": 3}
    await speaker.send(op="advertise", topic=topic, type=STRING, qos=qos)
    for text in "12345":
        await speaker.send(op="publish", topic=topic, msg={"data": text})
    await speaker.sync()
    heard = robot.listen(QoSProfile(depth=9, durability=LATCHED))
    await eventually(lambda: len(heard) >= 3)
    assert heard == ["3", "4", "5"]


async def test_a_message_beyond_its_lifespan_is_not_kept_for_later(
    speaker: Client, robot: Robot, topic: str
):
    qos = {"durability": "transient_local", "lifespan": 0.2}
    await speaker.send(op="advertise", topic=topic, type=STRING, qos=qos)
    await speaker.send(op="publish", topic=topic, msg={"data": "old"})
    heard = ["old"]
    async with asyncio.timeout(TIMEOUT_S):
        while heard[0] == "old":
            heard = robot.listen(QoSProfile(depth=9, durability=LATCHED))
            while not heard:
                await speaker.send(op="publish", topic=topic, msg={"data": "new"})
                await asyncio.sleep(0.05)


async def test_a_client_that_insists_on_a_missing_offer_is_told_and_no_other(
    gateway: GatewayProcess, speaker: Client, robot: Robot, topic: str
):
    publisher = robot.publisher(QoSProfile(depth=5, reliability=BEST_EFFORT))
    async with client(gateway.url) as strict:
        await speaker.send(op="subscribe", topic=topic, type=STRING)
        await strict.send(
            op="subscribe", id=7, topic=topic, type=STRING, qos={"reliability": "reliable"}
        )
        status = await strict.receive(is_warning)
        assert (status["level"], status["id"], status["request"]) == ("warning", 7, "subscribe")
        assert "/outside" in status["msg"]
        assert "best_effort" in status["msg"]
        await while_publishing(
            lambda: publisher.publish(String(data="x")), until_data(speaker, topic, "x")
        )
        assert not [frame for frame in await strict.sync() if frame["op"] == "publish"]
    assert not [frame for frame in await speaker.sync() if frame["op"] == "status"]


@pytest.mark.parametrize(
    ("offer", "options", "words"),
    [
        (QoSProfile(depth=1), {"durability": "transient_local"}, "durability volatile"),
        (QoSProfile(depth=1), {"deadline": 0.1}, "no deadline"),
        (QoSProfile(depth=1, deadline=Duration(seconds=1)), {"deadline": 0.1}, "of 1000 ms"),
    ],
)
async def test_each_thing_that_is_not_offered_is_told_in_words(
    speaker: Client,
    robot: Robot,
    topic: str,
    offer: QoSProfile,
    options: dict[str, Any],
    words: str,
):
    await speaker.send(op="subscribe", topic=topic, type=STRING, qos=options)
    robot.publisher(offer)
    status = await speaker.receive(is_warning)
    assert words in status["msg"]


async def test_best_available_is_what_all_publishers_offer(
    speaker: Client, robot: Robot, topic: str
):
    strong = robot.publisher(QoSProfile(depth=1, durability=LATCHED))
    weak = robot.publisher(QoSProfile(depth=1, reliability=BEST_EFFORT))
    best = {"reliability": "best_available", "durability": "best_available"}
    await speaker.send(op="subscribe", topic=topic, type=STRING, qos=best)
    for publisher, text in ((strong, "strong"), (weak, "weak")):

        def publish(publisher: Any = publisher, text: str = text) -> None:
            publisher.publish(String(data=text))

        await while_publishing(publish, until_data(speaker, topic, text))
    asked = await robot.asked()
    assert (asked.reliability, asked.durability) == (BEST_EFFORT, VOLATILE)
    assert not [frame for frame in await speaker.sync() if frame["op"] == "status"]
