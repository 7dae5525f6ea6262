# SPDX-License-Identifier: Apache-2.0
"""Transforms for clients, from what comes on /tf and /tf_static."""

import asyncio
from typing import Any

import pytest

from gateway.codec.types import Types
from gateway.core.errors import ProtocolError
from gateway.core.requests import LookupTransform
from gateway.core.topic_types import TopicTypes
from gateway.core.transforms import tf_listener
from gateway.core.transforms.lookups import TransformLookups
from gateway.tf import buffer
from schemas.installed import InstalledDefinitions
from schemas.table import Table
from tests.client import eventually
from tests.clock import StoppedClock
from tests.core.conftest import LIMITS, Bench, Socketless
from tests.core.transforms.conftest import Robot

SECOND = 1_000_000_000


def ask(client: Socketless, **more: Any) -> None:
    client.send(op="lookup_transform", **{"target_frame": "odom", "source_frame": "laser"} | more)


async def begin(robot: Robot, client: Socketless, **more: Any) -> None:
    """Ask, and let the gateway listen to the robot."""
    ask(client, **more)
    await robot.bench.settle()


def xs(client: Socketless) -> list[tuple[int, float]]:
    """Return seconds and x of the transforms that a client got."""
    transforms = [frame["transform"] for frame in client.of("lookup_transform")]
    return [(t["header"]["stamp"]["sec"], t["transform"]["translation"]["x"]) for t in transforms]


async def test_a_lookup_waits_for_the_data_and_is_answered(robot: Robot, client: Socketless):
    await begin(robot, client, id="where", timeout=30)
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
    await begin(robot, client, time={"sec": 6, "nanosec": 500_000_000}, timeout=30)
    robot.drive(6, 0.0)
    robot.drive(7, 1.0)
    await client.sees(1, "lookup_transform")
    assert xs(client) == [(6, 1.5)]


async def test_a_time_of_zero_is_the_newest(robot: Robot, client: Socketless):
    await begin(robot, client, time={"sec": 0}, timeout=30)
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
            {"time": {"sec": 4}, "timeout": 60},
            "timeout",
            "base_link in odom: oldest is 1 s newer than asked",
        ),
        (
            {"source_frame": "x" * 256},
            "not_found",
            f"frame '{'x' * 118}...",
        ),
        (
            {"source_frame": "x" * 257},
            "bad_request",
            "source_frame: expected at most 256 characters, got a string",
        ),
        ({"timeout": 61}, "bad_request", "timeout: expected at most 60, got 61"),
        ({"target_frame": 7}, "bad_request", "target_frame: expected a string, got 7"),
        (
            {"rate": 5, "time": {"sec": 1}},
            "bad_request",
            "time: not allowed with rate, which sends the newest",
        ),
    ],
)
async def test_a_failed_lookup_says_why(robot: Robot, client: Socketless, request_, code, words):
    robot.say(robot.fixed, "lens", "tripod", 0, 0.0)
    ask(client, rate=100)  # which keeps the buffer filled
    await robot.drives(5, 2.0)
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

    types = TopicTypes(bench.ros, Types(NoTf()), Table.load())
    transforms = TransformLookups(tf_listener.TfListener(bench.ros, types))
    with pytest.raises(ProtocolError, match="transforms need package tf2_msgs") as caught:
        await transforms.lookup(LookupTransform(target_frame="a", source_frame="b"))
    assert caught.value.code == "bad_type"


async def test_a_repeated_lookup_sends_what_changed(robot: Robot, client: Socketless):
    await begin(robot, client, id="pose", rate=200)
    for sec in (1, 2):
        robot.drive(sec, float(sec))
        await eventually(lambda sec=sec: len(xs(client)) == sec)
    robot.drive(2, 2.0)  # the same again: nothing new
    for sec in (2, 3):  # and what has nothing to do with it
        robot.say(robot.moving, "arm", "base_link", sec, 0.0)
        other = robot.bench.client()
        ask(other, source_frame="arm", target_frame="base_link", time={"sec": sec}, timeout=30)
        await other.sees(1, "lookup_transform")
    robot.drive(3, 2.0)
    await eventually(lambda: len(xs(client)) == 3)
    assert xs(client) == [(1, 2.0), (2, 3.0), (3, 3.0)]
    assert {frame["id"] for frame in client.of("lookup_transform")} == {"pose"}


async def test_a_frame_whose_stamps_are_all_equal_moves(robot: Robot, client: Socketless):
    await begin(robot, client, rate=200)
    for count, x in enumerate((1.0, 2.0, 1.0), 1):  # without a clock, each stamp is 0
        robot.drive(0, x)
        await eventually(lambda count=count: len(xs(client)) == count)
    assert xs(client) == [(0, 2.0), (0, 3.0), (0, 2.0)]


async def test_a_cancelled_lookup_sends_nothing_more(robot: Robot, client: Socketless):
    other = robot.bench.client()
    ask(client, id="pose", rate=200)
    ask(other, rate=200)
    await robot.drives(1, 1.0)
    await client.sees(1, "lookup_transform")
    client.is_paused = True
    for sec in (2, 3):
        robot.drive(sec, 2.0)
        await other.sees(sec, "lookup_transform")
        if sec == 2:
            client.send(op="cancel_transform", id="pose")
    client.resume()
    assert len(xs(client)) == 1  # nor is what waited
    client.send(op="cancel_transform", id="pose")
    assert client.statuses == [("not_found", "no repeated lookup with id 'pose'")]


async def test_one_who_joins_gets_at_once_what_the_others_have(robot: Robot, client: Socketless):
    await begin(robot, client, id="pose", rate=0.001)
    robot.drive(1, 1.0)
    other = robot.bench.client()
    # the first look of a new pair is also at once
    ask(other, id=2, rate=0.002)
    await other.sees(1, "lookup_transform")
    third = robot.bench.client()
    ask(third, rate=0.002)
    assert xs(third) == [(1, 2.0)]
    assert "id" not in third.of("lookup_transform")[0]


async def test_a_repeated_lookup_sends_at_most_so_often(robot: Robot, client: Socketless):
    loop = asyncio.get_running_loop()
    quick = robot.bench.client()
    begin = loop.time()
    ask(client, rate=20)
    ask(quick, rate=200)
    await robot.bench.settle()
    for sec in range(1, 31):
        robot.drive(sec, 0.0)
        await quick.sees(sec, "lookup_transform")
    got = len(xs(client))
    assert 1 <= got <= 1 + (loop.time() - begin) * 20
    # also the last one, when it is due
    await eventually(lambda: (30, 1.0) in xs(client))


async def test_the_beat_of_a_repeated_lookup_does_not_drift_with_a_busy_loop(
    robot: Robot, client: Socketless, monkeypatch: pytest.MonkeyPatch
):
    clock = StoppedClock(monkeypatch)
    await begin(robot, client, rate=10)
    for sec, wait_s in ((1, 0.02), (2, 0.14), (3, 0.061)):  # due at 0.02, 0.12 and 0.22 s
        robot.drive(sec, 0.0)
        await robot.bench.settle()
        await clock.advance(wait_s)
        assert len(xs(client)) == sec
    robot.drive(4, 0.0)
    await clock.advance(0.09)
    assert len(xs(client)) == 3


async def test_a_waiting_lookup_looks_again_after_a_pause_however_much_comes(
    robot: Robot,
    client: Socketless,
    looks: list[tuple[str, str]],
    monkeypatch: pytest.MonkeyPatch,
):
    clock = StoppedClock(monkeypatch)
    await begin(robot, client, timeout=30)
    looks.clear()
    for number in range(10):
        robot.say(robot.moving, f"other_{number}", "odom", 1, 0.0)
        await robot.bench.settle()
    await clock.advance(0.019)
    assert looks == []
    await clock.advance(0.002)
    assert looks == [("odom", "laser")]


async def test_a_lookup_without_a_timeout_waits_for_a_second(
    robot: Robot, client: Socketless, monkeypatch: pytest.MonkeyPatch
):
    clock = StoppedClock(monkeypatch)
    await begin(robot, client)
    await clock.advance(0.99)
    assert client.statuses == []
    await clock.advance(0.02)
    assert client.statuses == [("not_found", "frame 'odom' is unknown")]


async def test_a_late_transform_is_sent_at_once_at_any_rate(robot: Robot, client: Socketless):
    ask(client, rate=0.001, timeout=0)
    await client.sees(1, "status")
    robot.drive(1, 1.0)
    await client.sees(1, "lookup_transform")


async def test_while_nothing_changes_nothing_is_looked_up(
    robot: Robot, client: Socketless, looks: list[tuple[str, str]]
):
    await begin(robot, client, rate=200)
    robot.drive(1, 1.0)
    await client.sees(1, "lookup_transform")
    looks.clear()
    robot.drive(1, 1.0)  # as it was
    other = robot.bench.client()
    for rate in (10, 100):
        ask(other, id=rate, source_frame="nowhere", rate=rate, timeout=0.05)
    await other.sees(2, "status")
    assert ("odom", "laser") not in looks


async def test_nothing_is_looked_up_for_those_who_have_cancelled_or_left(
    robot: Robot, client: Socketless, looks: list[tuple[str, str]]
):
    leaving, staying = robot.bench.client(), robot.bench.client()
    ask(client, id="pose", rate=5)
    ask(leaving, source_frame="base_link", rate=5)
    await robot.drives(1, 1.0)
    for each in (client, leaving):
        await each.sees(1, "lookup_transform")
    ask(staying, source_frame="laser", target_frame="base_link", rate=5)
    await staying.sees(1, "lookup_transform")
    robot.drive(2, 2.0)
    robot.say(robot.fixed, "laser", "base_link", 0, 2.0)
    await robot.bench.settle()
    # now the next look of each is due, that of the one who stays after the others'
    client.send(op="cancel_transform", id="pose")
    robot.bench.router.leave(leaving.session)
    looks.clear()
    await staying.sees(2, "lookup_transform")
    assert set(looks) <= {("base_link", "laser")}


async def test_a_missing_transform_is_reported_once_and_waited_for(
    robot: Robot, client: Socketless
):
    ask(client, id="pose", rate=200, timeout=0)
    [status] = await client.sees(1, "status")
    assert (status["level"], status["code"], status["id"]) == ("warning", "not_found", "pose")
    assert status["msg"].endswith("is unknown")
    robot.say(robot.moving, "arm", "torso", 1, 0.0)
    robot.drive(1, 1.0)
    await client.sees(1, "lookup_transform")
    assert len(client.statuses) == 1


async def test_a_transform_that_is_missing_again_is_reported_again(
    robot: Robot, client: Socketless
):
    ask(client, rate=200, timeout=0)
    for count in (1, 2):
        await client.sees(count, "status")
        robot.drive(1000, 5.0)
        await client.sees(count, "lookup_transform")
        robot.bench.ros.set_time(robot.bench.ros.now - 1000 * SECOND)
    await client.sees(3, "status")


async def test_nobody_hears_of_what_was_missing_after_cancelling(robot: Robot, client: Socketless):
    patient = robot.bench.client()
    ask(client, id="pose", rate=10, timeout=0.05)
    ask(patient, rate=10, timeout=0.06)
    client.send(op="cancel_transform", id="pose")
    await patient.sees(1, "status")
    assert client.statuses == []


async def test_a_missing_transform_is_reported_to_a_client_that_joins(
    robot: Robot, client: Socketless
):
    ask(client, rate=10, timeout=0)
    await client.sees(1, "status")
    other = robot.bench.client()
    ask(other, rate=10, timeout=0)
    await other.sees(1, "status")


async def test_for_a_slow_client_only_the_newest_waits(robot: Robot, client: Socketless):
    quick = robot.bench.client()
    for each in (client, quick):
        ask(each, rate=200)
    await robot.bench.settle()
    client.is_paused = True
    for sec in range(1, 9):
        robot.drive(sec, float(sec))
        await eventually(lambda sec=sec: len(xs(quick)) == sec)
    client.resume()
    assert xs(client) == [(8, 9.0)]
    assert client.session.outbox.dropped == 7


async def test_a_client_that_leaves_waits_for_no_transform(robot: Robot, client: Socketless):
    await begin(robot, client, timeout=30)
    assert robot.bench.router.counts()["calls"] == 1
    robot.bench.router.leave(client.session)
    await robot.bench.settle()
    assert robot.bench.router.counts()["calls"] == 0
    robot.drive(1, 1.0)
    await robot.bench.settle()
    assert client.frames == []


async def test_repeated_lookups_are_limited_per_client_and_replaced_by_id(
    robot: Robot, client: Socketless
):
    for number in range(LIMITS.max_transforms):
        ask(client, id=number, rate=1)
    ask(client, id=0, rate=2)
    assert client.statuses == []
    ask(client, id="more", rate=1)
    text = f"at most {LIMITS.max_transforms} repeated lookups per client"
    refusal = ("limit_exceeded", f"{text}: end one, or raise limits.max_transforms")
    assert client.statuses == [refusal]


async def test_repeated_lookups_are_counted_until_their_client_leaves(
    robot: Robot, client: Socketless
):
    router = robot.bench.router
    ask(client, id="head", rate=1)
    ask(client, id="hand", rate=1)
    assert router.counts()["transforms"] == 2
    client.send(op="cancel_transform", id="head")
    assert router.counts()["transforms"] == 1
    router.leave(client.session)
    assert router.counts()["transforms"] == 0


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


async def test_listening_goes_on_for_30_s_with_room_for_100_messages(
    robot: Robot, client: Socketless, monkeypatch: pytest.MonkeyPatch
):
    clock = StoppedClock(monkeypatch)
    ask(client, id="pose", rate=10)
    assert [each.qos.depth for each in robot.bench.ros.subscriptions] == [100, 100]
    client.send(op="cancel_transform", id="pose")
    await clock.advance(29.9)
    assert len(robot.subscriptions) == 2
    await clock.advance(0.2)
    assert robot.subscriptions == []


async def test_after_a_single_lookup_listening_ends_and_all_is_forgotten(
    robot: Robot, client: Socketless, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(tf_listener, "LINGER_S", 0.1)
    await begin(robot, client, timeout=30)
    robot.drive(5, 2.0)
    await client.sees(1, "lookup_transform")
    await eventually(lambda: not robot.subscriptions)
    ask(client, target_frame="base_link", timeout=30)  # it is static, and published again
    await client.sees(2, "lookup_transform")
    ask(client, timeout=0)
    await client.sees(1, "status")
    assert client.statuses == [("not_found", "frame 'odom' is unknown")]


async def test_when_the_clock_goes_back_what_moved_is_forgotten(robot: Robot, client: Socketless):
    await begin(robot, client, rate=200)
    robot.drive(1000, 5.0)
    await client.sees(1, "lookup_transform")
    robot.bench.ros.set_time(robot.bench.ros.now - 1)
    await robot.bench.settle()
    other = robot.bench.client()
    ask(other, timeout=0)
    await other.sees(1, "status")
    robot.say(robot.moving, "hand", "arm", 1, 1.0)
    ask(other, source_frame="hand", target_frame="arm", timeout=30)
    await other.sees(1, "lookup_transform")
    ask(other, timeout=0)
    await other.sees(2, "status")
    assert other.statuses == [("not_found", "frame 'odom' is unknown")] * 2
    # and that only once
    robot.say(robot.moving, "arm", "torso", 1, 1.0)
    ask(other, source_frame="hand", target_frame="torso", timeout=30)
    await other.sees(2, "lookup_transform")
    robot.drive(2, 0.0)
    await client.sees(2, "lookup_transform")
    assert xs(client) == [(1000, 6.0), (2, 1.0)]


async def test_an_invalid_transform_is_logged_once_and_harms_nothing(
    robot: Robot, client: Socketless
):
    await begin(robot, client, rate=200)
    for _ in range(2):
        robot.say(robot.moving, "odom", "odom", 1, 0.0)
        robot.moving.publish(b"\0\1\0\0")
    robot.drive(1, 0.0)
    await client.sees(1, "lookup_transform")
    first, second = robot.warnings
    assert first == "tf: frame 'odom': it is said to be in itself"
    assert second.startswith("tf: tf2_msgs/msg/TFMessage: need 8 bytes")


async def test_a_frame_that_is_fixed_and_moves_is_logged_once(robot: Robot, client: Socketless):
    await begin(robot, client, rate=200)
    robot.drive(1, 0.0)
    await client.sees(1, "lookup_transform")
    for x in (1.0, 2.0):
        robot.say(robot.fixed, "base_link", "odom", 0, x)
    robot.drive(2, 0.0)
    await client.sees(2, "lookup_transform")
    assert robot.warnings == [
        "tf: frame 'base_link': it is published as static and as moving, so it counts as moving"
    ]


async def test_of_each_kind_of_fault_some_frames_are_logged_until_listening_ends(
    robot: Robot, client: Socketless, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(tf_listener, "LINGER_S", 0.0)
    monkeypatch.setattr(tf_listener, "_MAX_WARNINGS", 2)
    for sec in (1, 2):
        await begin(robot, client, id="pose", rate=200)
        for frame in ("a", "b", "c"):
            robot.say(robot.moving, frame, frame, 1, 0.0)
        for frame in ("x" * 200, "x" * 201, "b", "c"):
            robot.say(robot.moving, frame, "odom", 1, 0.0, rotation={"w": 0.0})
        robot.drive(sec, 0.0)
        await client.sees(sec, "lookup_transform")
        assert robot.warnings == sec * [
            "tf: frame 'a': it is said to be in itself",
            "tf: frame 'b': it is said to be in itself",
            f"tf: frame '{'x' * 125}...': its quaternion has no direction",
            "tf: frame 'b': its quaternion has no direction",
        ]
        client.send(op="cancel_transform", id="pose")
        await eventually(lambda: not robot.subscriptions)


async def test_of_one_kind_of_fault_eight_frames_are_logged(robot: Robot, client: Socketless):
    await begin(robot, client, rate=200)
    for number in range(10):
        robot.say(robot.moving, f"frame_{number}", f"frame_{number}", 1, 0.0)
    await robot.bench.settle()
    assert [text.split("'")[1] for text in robot.warnings] == [f"frame_{n}" for n in range(8)]


async def test_a_message_with_too_many_frames_does_no_harm(
    robot: Robot, client: Socketless, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(buffer, "MAX_FRAMES", 4)
    await begin(robot, client, rate=200)
    robot.drive(1, 0.0)
    for frame in ("a", "b", "c"):
        robot.say(robot.moving, frame, "odom", 1, 0.0)
    robot.drive(2, 0.0)
    await eventually(lambda: (2, 1.0) in xs(client))
    assert robot.warnings == [f"tf: frame '{frame}': at most 4 frames are kept" for frame in "bc"]
