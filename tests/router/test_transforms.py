# SPDX-License-Identifier: Apache-2.0
"""Transforms for clients, from what comes on /tf and /tf_static."""

from typing import Any

import pytest

from gateway.codec.types import Types
from gateway.ports import Qos
from gateway.protocol.errors import ProtocolError
from gateway.protocol.operations.transforms import LookupTransform
from gateway.router import tf_listener
from gateway.router.tf_listener import TF_MESSAGE
from gateway.router.topic_types import TopicTypes
from gateway.router.transforms import Transforms
from schemas.installed import InstalledDefinitions
from schemas.table import Table
from tests import interfaces
from tests.client import eventually
from tests.ros.fake import FakePublisher
from tests.router.conftest import LIMITS, Bench, Socketless

pytestmark = pytest.mark.skipif(
    not InstalledDefinitions().names(["tf2_msgs"]), reason=interfaces.HOW
)

SECOND = 1_000_000_000
LATCHED = Qos(durability="transient_local")


class Robot:
    """What publishes the frames."""

    def __init__(self, bench: Bench) -> None:
        self.bench = bench
        self.moving = bench.ros.add_publisher("/tf", TF_MESSAGE)
        self.fixed = bench.ros.add_publisher("/tf_static", TF_MESSAGE, LATCHED)
        self.say(self.fixed, "laser", "base_link", 0, 1.0)

    def say(
        self, publisher: FakePublisher, child: str, parent: str, sec: int, x: float, **other: Any
    ) -> None:
        stamped = {
            "header": {"stamp": {"sec": sec, "nanosec": 0}, "frame_id": parent},
            "child_frame_id": child,
            "transform": {"translation": {"x": x}, **other},
        }
        publisher.publish(self.bench.cdr(TF_MESSAGE, transforms=[stamped]))

    def drive(self, sec: int, x: float) -> None:
        self.say(self.moving, "base_link", "odom", sec, x)

    @property
    def subscriptions(self) -> list[str]:
        return [subscription.topic for subscription in self.bench.ros.subscriptions]


@pytest.fixture
def robot(bench: Bench) -> Robot:
    return Robot(bench)


@pytest.fixture
def client(bench: Bench) -> Socketless:
    return bench.client()


def ask(client: Socketless, **more: Any) -> None:
    client.send(op="lookup_transform", **{"target_frame": "odom", "source_frame": "laser"} | more)


def xs(client: Socketless) -> list[tuple[int, float]]:
    """Return seconds and x of the transforms that a client got."""
    transforms = [frame["transform"] for frame in client.of("lookup_transform")]
    return [(t["header"]["stamp"]["sec"], t["transform"]["translation"]["x"]) for t in transforms]


async def test_a_lookup_waits_for_the_data_and_is_answered(robot: Robot, client: Socketless):
    ask(client, id="where", timeout=30)
    await robot.bench.settle()
    robot.drive(5, 2.0)
    [frame] = await client.sees(1, "lookup_transform")
    assert frame == {
        "op": "lookup_transform",
        "id": "where",
        "transform": {
            "header": {"stamp": {"sec": 5, "nanosec": 0}, "frame_id": "odom"},
            "child_frame_id": "laser",
            "transform": {
                "translation": {"x": 3.0, "y": 0.0, "z": 0.0},
                "rotation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0},
            },
        },
    }


async def test_a_lookup_at_a_time_interpolates(robot: Robot, client: Socketless):
    ask(client, time={"sec": 6, "nanosec": 500_000_000}, timeout=30)
    await robot.bench.settle()
    robot.drive(6, 0.0)
    robot.drive(7, 1.0)
    await client.sees(1, "lookup_transform")
    assert xs(client) == [(6, 1.5)]


async def test_a_time_of_zero_is_the_newest(robot: Robot, client: Socketless):
    ask(client, time={"sec": 0}, timeout=30)
    await robot.bench.settle()
    robot.drive(6, 0.0)
    await client.sees(1, "lookup_transform")
    assert xs(client) == [(6, 1.0)]


@pytest.mark.parametrize(
    ("request_", "code", "words"),
    [
        ({"source_frame": "lasr"}, "not_found", "frame 'lasr' is unknown; did you mean laser?"),
        ({"source_frame": "lens"}, "not_found", "frames are not connected: odom, tripod .. lens"),
        ({"time": {"sec": 9}}, "timeout", "base_link in odom: newest is 4 s older than asked"),
        # which waiting will not help
        (
            {"time": {"sec": 4}, "timeout": 1e6},
            "timeout",
            "base_link in odom: oldest is 1 s newer than asked",
        ),
        ({"target_frame": 7}, "bad_request", "target_frame: expected a string, got 7"),
        (
            {"rate": 5, "time": {"sec": 1}},
            "bad_request",
            "time: a repeated one takes the newest",
        ),
    ],
)
async def test_what_cannot_be_looked_up_is_told_in_words(
    robot: Robot, client: Socketless, request_, code, words
):
    robot.say(robot.fixed, "lens", "tripod", 0, 0.0)
    ask(client, rate=100)  # which keeps the buffer filled
    await robot.bench.settle()
    robot.drive(5, 2.0)
    await client.sees(1, "lookup_transform")
    ask(client, id=1, **{"timeout": 0.01} | request_)
    [status] = await client.sees(1, "status")
    assert (status["code"], status["msg"], status["id"]) == (code, words, 1)


async def test_without_tf2_msgs_a_lookup_is_refused(bench: Bench):
    class NoTf(InstalledDefinitions):
        def _read(self, name: str) -> Any:
            if name.startswith("tf2_msgs"):
                name = "no_msgs/msg/Such"
            return super()._read(name)

    transforms = Transforms(bench.ros, TopicTypes(bench.ros, Types(NoTf()), Table.load()))
    with pytest.raises(ProtocolError, match="transforms need package tf2_msgs") as caught:
        await transforms.lookup(LookupTransform(target_frame="a", source_frame="b"))
    assert caught.value.code == "bad_type"


async def test_a_repeated_lookup_sends_what_changed(robot: Robot, client: Socketless):
    ask(client, id="pose", rate=200)
    await robot.bench.settle()
    for sec in (1, 2):
        robot.drive(sec, float(sec))
        await eventually(lambda sec=sec: len(xs(client)) == sec)
    robot.drive(2, 7.0)  # the same time again: nothing new
    for sec in (2, 3):  # and what has nothing to do with it
        robot.say(robot.moving, "arm", "base_link", sec, 0.0)
        other = robot.bench.client()
        ask(other, source_frame="arm", target_frame="base_link", time={"sec": sec}, timeout=30)
        await other.sees(1, "lookup_transform")
    robot.drive(3, 2.0)
    await eventually(lambda: len(xs(client)) == 3)
    assert xs(client) == [(1, 2.0), (2, 3.0), (3, 3.0)]
    assert {frame["id"] for frame in client.of("lookup_transform")} == {"pose"}


async def test_a_cancelled_lookup_sends_nothing_more(robot: Robot, client: Socketless):
    other = robot.bench.client()
    ask(client, id="pose", rate=200)
    ask(other, rate=200)
    await robot.bench.settle()
    robot.drive(1, 1.0)
    await client.sees(1, "lookup_transform")
    client.is_paused = True
    for sec in (2, 3):
        robot.drive(sec, 2.0)
        await other.sees(sec, "lookup_transform")
        if sec == 2:
            client.send(op="cancel_transform", id="pose")
    client.is_paused = False
    client.flush()
    assert len(xs(client)) == 1  # nor is what waited
    client.send(op="cancel_transform", id="pose")
    assert client.statuses == [("not_found", "no repeated lookup with id 'pose'")]


async def test_one_who_joins_gets_at_once_what_the_others_have(robot: Robot, client: Socketless):
    ask(client, id="pose", rate=0.001)
    await robot.bench.settle()
    robot.drive(1, 1.0)
    other = robot.bench.client()
    # the first look of a new pair is at once, too
    ask(other, id=2, rate=0.002)
    await other.sees(1, "lookup_transform")
    third = robot.bench.client()
    ask(third, rate=0.002)
    assert xs(third) == [(1, 2.0)]
    assert "id" not in third.of("lookup_transform")[0]


async def test_what_is_missing_is_told_once_and_waited_for(robot: Robot, client: Socketless):
    ask(client, id="pose", rate=200, timeout=0)
    [status] = await client.sees(1, "status")
    assert (status["level"], status["code"], status["id"]) == ("warning", "not_found", "pose")
    assert status["msg"].endswith("is unknown; waiting for it")
    robot.drive(1, 1.0)
    await client.sees(1, "lookup_transform")
    assert len(client.statuses) == 1


async def test_for_a_slow_client_only_the_newest_waits(robot: Robot, client: Socketless):
    quick = robot.bench.client()
    for each in (client, quick):
        ask(each, rate=200)
    await robot.bench.settle()
    client.is_paused = True
    for sec in range(1, 9):
        robot.drive(sec, float(sec))
        await eventually(lambda sec=sec: len(xs(quick)) == sec)
    client.is_paused = False
    client.flush()
    assert xs(client) == [(8, 9.0)]
    assert client.session.outbox.dropped == 7


async def test_repeated_lookups_are_limited_per_client_and_replaced_by_id(
    robot: Robot, client: Socketless
):
    for number in range(LIMITS.transforms):
        ask(client, id=number, rate=1)
    ask(client, id=0, rate=2)
    assert client.statuses == []
    ask(client, id="more", rate=1)
    assert client.statuses == [
        ("limit_exceeded", f"at most {LIMITS.transforms} repeated lookups per client")
    ]


async def test_listening_goes_on_for_a_while_and_ends(
    robot: Robot, client: Socketless, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(tf_listener, "LINGER_S", 0.2)
    ask(client, id="pose", rate=10)
    assert sorted(robot.subscriptions) == ["/tf", "/tf_static"]
    client.send(op="cancel_transform", id="pose")
    assert robot.subscriptions
    ask(client, id="pose", rate=10)
    robot.bench.router.leave(client.session)
    await eventually(lambda: not robot.subscriptions)


async def test_when_the_clock_goes_back_what_moved_is_forgotten(robot: Robot, client: Socketless):
    ask(client, rate=200)
    await robot.bench.settle()
    robot.drive(1000, 5.0)
    await client.sees(1, "lookup_transform")
    robot.bench.ros.now -= 1000 * SECOND
    robot.say(robot.moving, "arm", "torso", 1, 0.0)
    other = robot.bench.client()
    ask(other, source_frame="arm", target_frame="torso", timeout=30)
    await other.sees(1, "lookup_transform")
    ask(other, timeout=0)
    assert await other.sees(1, "status")
    assert other.statuses == [("not_found", "frame 'odom' is unknown")]
    robot.drive(2, 0.0)
    await client.sees(2, "lookup_transform")
    assert xs(client) == [(1000, 6.0), (2, 1.0)]


async def test_what_is_no_transform_is_logged_once_and_harms_nothing(
    robot: Robot, client: Socketless
):
    ask(client, rate=200)
    await robot.bench.settle()
    for _ in range(2):
        robot.say(robot.moving, "odom", "odom", 1, 0.0)
        robot.moving.publish(b"\0\1\0\0")
    robot.drive(1, 0.0)
    await client.sees(1, "lookup_transform")
    logged = [text for _, text in robot.bench.ros.logged if text.startswith("tf: ")]
    assert logged[0] == "tf: frame odom is said to be in itself"
    assert len(logged) == 2
