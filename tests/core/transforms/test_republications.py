# SPDX-License-Identifier: Apache-2.0
"""Arrays of transforms: which frames are sent when, and to whom."""

import asyncio
import math
from types import SimpleNamespace
from typing import Any

import pytest

from gateway.core.transforms import republications, tf_listener
from gateway.sources.source import RosError
from gateway.tf.buffer import Buffer
from tests.clock import StoppedClock
from tests.core.conftest import LIMITS, Bench, Socketless
from tests.core.transforms.asking import ACTION, send_goal, transforms, xs
from tests.core.transforms.conftest import Robot


class Stage:
    """A robot, and a clock that stands unless it is told to go on."""

    def __init__(self, robot: Robot, clock: StoppedClock) -> None:
        self.robot = robot
        self.clock = clock

    async def step(self, seconds: float = 0.02) -> None:
        """Let what was said be heard, and then time pass: one turn at 200 Hz, or none at 10."""
        await self.robot.bench.settle()
        await self.clock.advance(seconds)

    async def drive(self, sec: int, x: float) -> None:
        self.robot.drive(sec, x)
        await self.step()

    async def begin(self, client: Socketless, **more: Any) -> None:
        """Let a client have the first array, in which the robot is where it began."""
        send_goal(client, **more)
        await self.step(0)
        await self.drive(1, 0.0)
        assert len(transforms(client)) == 1


@pytest.fixture
async def stage(robot: Robot, monkeypatch: pytest.MonkeyPatch) -> Stage:
    return Stage(robot, StoppedClock(monkeypatch))


async def test_the_first_array_has_all_frames(stage: Stage, client: Socketless):
    await stage.begin(client)
    [array] = transforms(client)
    assert array == [
        {
            "header": {"stamp": {"sec": 1, "nanosec": 0}, "frame_id": "odom"},
            "child_frame_id": frame,
            "transform": {
                "translation": {"x": x, "y": 0.0, "z": 0.0},
                "rotation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0},
            },
        }
        for frame, x in (("base_link", 0.0), ("laser", 1.0))
    ]


async def test_a_frame_is_sent_again_when_it_has_moved_by_more_than_the_threshold(
    stage: Stage, client: Socketless
):
    await stage.begin(client)
    # each step is below the threshold. What counts is the way since it was sent last
    for sec, x in ((2, 0.3), (3, 0.5), (3, 0.6), (5, 1.0), (5, 1.2)):  # stamps may be equal
        await stage.drive(sec, x)
    assert [array["base_link"] for array in xs(transforms(client))] == [0.0, 0.6, 1.2]


@pytest.mark.parametrize("sign", [1, -1])  # of the quaternion, which means the same rotation
async def test_a_frame_is_sent_again_when_it_has_turned_by_more_than_the_threshold(
    stage: Stage, client: Socketless, sign: int
):
    # without the laser, which moves when its base turns
    await stage.begin(client, source_frames=["base_link"])
    for sec, angle in ((2, 0.45), (3, 0.55), (4, 0.95)):
        turned = {"z": sign * math.sin(angle / 2), "w": sign * math.cos(angle / 2)}
        stage.robot.say(stage.robot.moving, "base_link", "odom", sec, 0.0, rotation=turned)
        await stage.step()
    [_, second] = transforms(client)
    assert second[0]["header"]["stamp"]["sec"] == 3


async def test_only_the_frames_that_have_moved_are_sent(stage: Stage, client: Socketless):
    await stage.begin(client, source_frames=["base_link", "arm"])
    stage.robot.say(stage.robot.moving, "arm", "odom", 1, 5.0)
    await stage.step()
    await stage.drive(2, 2.0)
    assert xs(transforms(client)) == [{"base_link": 0.0}, {"arm": 5.0}, {"base_link": 2.0}]


async def test_frames_that_move_between_two_turns_come_together(stage: Stage, client: Socketless):
    robot = stage.robot
    send_goal(client, rate=10)
    await stage.step(0)
    for tenth in range(4):
        await stage.drive(tenth + 1, float(tenth))
        robot.say(robot.fixed, "laser", "base_link", 0, float(tenth))
        assert len(transforms(client)) == tenth
        await stage.step(0.081)
        assert len(transforms(client)) == tenth + 1
    assert xs(transforms(client))[-1] == {"base_link": 3.0, "laser": 6.0}


async def test_with_thresholds_of_zero_what_stands_still_is_not_sent(
    stage: Stage, client: Socketless
):
    await stage.begin(client, trans_thres=0, angular_thres=0)
    await stage.drive(2, 0.0)  # later, and where it was
    assert len(transforms(client)) == 1
    await stage.drive(3, 1e-9)
    assert xs(transforms(client))[1]["base_link"] == 1e-9


async def test_without_a_rate_it_is_10_hz(stage: Stage, client: Socketless):
    send_goal(client, rate=0)
    await stage.step(0)
    for sec in (1, 2):
        stage.robot.drive(sec, float(sec))
        await stage.step(0.09)
        assert len(transforms(client)) == sec - 1
        await stage.step(0.011)
        assert len(transforms(client)) == sec


async def test_a_slow_array_begins_as_soon_as_others(stage: Stage, client: Socketless):
    send_goal(client, rate=0.001)
    await stage.step(0)
    stage.robot.drive(1, 0.0)
    await stage.step(0.09)
    assert transforms(client) == []
    await stage.step(0.011)
    assert len(transforms(client)) == 1
    stage.robot.drive(2, 5.0)
    await stage.step(990)
    assert len(transforms(client)) == 1


async def test_a_leading_slash_is_dropped_and_a_frame_is_sent_once(
    stage: Stage, client: Socketless
):
    await stage.begin(client, target_frame="/odom", source_frames=["/laser", "laser"])
    [[laser]] = transforms(client)
    assert (laser["header"]["frame_id"], laser["child_frame_id"]) == ("odom", "laser")


async def test_equal_arrays_are_looked_up_once_and_one_that_joins_gets_what_the_others_have(
    stage: Stage, client: Socketless, looks: list[tuple[str, str]]
):
    await stage.begin(client)
    await stage.drive(2, 0.4)  # below the threshold
    other = stage.robot.bench.client()
    send_goal(other)
    assert xs(transforms(other)) == [{"base_link": 0.0, "laser": 1.0}]
    looks.clear()
    await stage.drive(3, 0.8)
    assert sorted(looks) == [("odom", "base_link"), ("odom", "laser")]
    assert xs(transforms(client)[1:]) == [{"base_link": 0.8, "laser": 1.8}]
    assert transforms(other)[1] == transforms(client)[1]


async def test_a_slow_client_gets_the_newest_of_every_frame_in_one_message(
    stage: Stage, client: Socketless
):
    send_goal(client, source_frames=["base_link", "arm"])
    client.is_paused = True
    await stage.step(0)
    stage.robot.say(stage.robot.moving, "arm", "odom", 1, 5.0)
    await stage.step()
    for sec in range(2, 5):
        await stage.drive(sec, float(sec))
    client.resume()
    assert xs(transforms(client)) == [{"arm": 5.0, "base_link": 4.0}]


async def test_frames_that_a_full_outbox_drops_come_with_the_next_ones(
    stage: Stage, client: Socketless
):
    await stage.begin(client, source_frames=["base_link", "arm"])
    client.is_paused = True
    stage.robot.say(stage.robot.moving, "arm", "odom", 1, 5.0)
    await stage.step()
    [queue] = client.session.outbox._queues
    queue.drop_oldest()
    client.resume()
    assert len(transforms(client)) == 1
    await stage.drive(2, 3.0)
    assert xs(transforms(client))[1] == {"arm": 5.0, "base_link": 3.0}


async def test_after_the_end_of_the_last_one_nothing_is_looked_up_nor_heard(
    stage: Stage, client: Socketless, looks: list[tuple[str, str]]
):
    robot = stage.robot
    router = robot.bench.router
    leaving, staying = robot.bench.client(), robot.bench.client()
    await stage.begin(client, rate=200)
    send_goal(client, "slow", rate=5)
    send_goal(leaving, source_frames=["base_link"], rate=5)
    send_goal(staying, source_frames=["laser"], target_frame="base_link", rate=5)
    await stage.step()
    assert len(transforms(leaving)) == 1 == len(transforms(staying))
    assert router.counts()["transforms"] == 4
    robot.drive(2, 2.0)
    robot.say(robot.fixed, "laser", "base_link", 0, 2.0)
    await stage.step()  # now the next look of each is due
    for goal in ("goal", "slow"):
        client.send(op="cancel_action_goal", id=goal, action=ACTION)
    assert len(client.session.outbox._queues) == 0
    router.leave(leaving.session)
    looks.clear()
    await stage.step(0.3)
    assert looks == [("base_link", "laser")]
    assert router.counts()["transforms"] == 1
    router.leave(staying.session)
    assert router.counts()["transforms"] == 0
    await stage.step(tf_listener.LINGER_S + 1)
    assert robot.subscriptions == []


async def test_an_array_that_begins_after_the_end_of_an_equal_one_has_the_frames_as_they_are(
    stage: Stage, client: Socketless
):
    await stage.begin(client)
    client.send(op="cancel_action_goal", id="goal", action=ACTION)
    await stage.drive(2, 9.0)
    send_goal(client)
    await stage.step()
    assert xs(transforms(client)[1:]) == [{"base_link": 9.0, "laser": 10.0}]


async def test_frames_that_are_missing_are_told_once_and_waited_for(
    stage: Stage, client: Socketless
):
    send_goal(client, "a", source_frames=["base_link", "lasr", "lens"])
    send_goal(client, "b", source_frames=["base_link", "lens"])
    send_goal(client, "c", source_frames=["base_link"])
    send_goal(client, "d", source_frames=["lens"])
    await stage.step(0)
    stage.robot.drive(1, 0.0)
    await stage.step(0.99)
    assert client.statuses == []
    client.send(op="cancel_action_goal", id="d", action=ACTION)
    await stage.step(0.02)
    first = "frame 'lasr' is unknown; did you mean laser?, and 1 more are missing; waiting"
    warned = {frame["id"]: (frame["code"], frame["msg"]) for frame in client.of("status")}
    assert warned == {
        "a": ("not_found", first),
        "b": ("not_found", "frame 'lens' is unknown; waiting"),
    }
    stage.robot.say(stage.robot.moving, "lens", "odom", 2, 7.0)
    await stage.step(10)
    assert xs(transforms(client)).count({"lens": 7.0}) == 2
    assert len(client.statuses) == 2


async def test_of_many_frames_that_were_not_sent_eight_are_looked_at_for_the_reason():
    looks: list[str] = []
    buffer = SimpleNamespace(lookup=lambda target, source: looks.append(source))
    key = republications.ArrayKey("odom", tuple(map(str, range(1000))), 1.0, 0.0, 0.0)
    array = republications._SharedArray(key, buffer)  # type: ignore[arg-type]
    assert array.reason(array.missing()) is None  # each has come since
    assert looks == list("01234567")
    array.stop()


async def test_when_time_jumps_back_a_frame_is_sent_once_it_is_known_again(
    stage: Stage, client: Socketless
):
    await stage.begin(client)
    ros = stage.robot.bench.ros
    ros.set_time(ros.now - 1)
    await stage.step()
    await stage.drive(1, 9.0)
    assert xs(transforms(client))[1:] == [{"base_link": 9.0, "laser": 10.0}]


async def test_arrays_are_limited_per_client(robot: Robot, client: Socketless):
    for number in range(LIMITS.max_transforms):
        send_goal(client, str(number), source_frames=["laser"])
    assert client.of("action_result") == []
    send_goal(client, "more", source_frames=["laser"])
    [refusal] = client.of("action_result")
    assert refusal["id"] == "more"
    assert refusal["values"] == (
        f"at most {LIMITS.max_transforms} arrays of transforms per client: end one, or raise "
        "limits.max_transforms"
    )
    client.send(op="cancel_action_goal", id="0", action=ACTION)
    send_goal(client, "again", source_frames=["laser"])
    assert len(client.of("action_result")) == 2  # the one of goal 0


@pytest.mark.parametrize(("look_s", "is_split"), [(0.0039, False), (0.0041, True)])
async def test_work_beyond_a_slice_of_4_ms_goes_on_in_the_next_turn_of_the_loop(
    stage: Stage,
    client: Socketless,
    looks: list[tuple[str, str]],
    monkeypatch: pytest.MonkeyPatch,
    look_s: float,
    is_split: bool,
):
    await stage.begin(client)
    clock = SimpleNamespace(monotonic=lambda: 1000.0 + look_s * len(looks))
    monkeypatch.setattr(republications, "time", clock)
    turns: list[list[tuple[str, str]]] = []
    loop = asyncio.get_running_loop()

    def look_on() -> None:
        turns.append(list(looks))
        if len(transforms(client)) < 2:
            loop.call_soon(look_on)

    looks.clear()
    loop.call_soon(look_on)
    await stage.drive(2, 2.0)
    assert ([("odom", "base_link")] in turns) == is_split  # others had their turn in between
    assert looks == [("odom", "base_link"), ("odom", "laser")]
    assert xs(transforms(client)[1:]) == [{"base_link": 2.0, "laser": 3.0}]


async def test_clients_that_have_no_time_left_are_sent_less_often(
    stage: Stage, client: Socketless, looks: list[tuple[str, str]]
):
    await stage.begin(client)
    has_time = False
    client.turns.spend = lambda spent_s, now_s: has_time
    looks.clear()
    for sec in (2, 3, 4):
        await stage.drive(sec, float(sec))
    assert looks == []
    has_time = True
    await stage.step(0.02)
    assert xs(transforms(client)[1:]) == [{"base_link": 4.0, "laser": 5.0}]


async def test_an_array_goes_on_while_one_of_its_clients_has_time_left(
    stage: Stage, client: Socketless
):
    other = stage.robot.bench.client()
    await stage.begin(client)
    send_goal(other)
    client.turns.spend = lambda spent_s, now_s: False
    other.turns.spend = lambda spent_s, now_s: True
    await stage.drive(2, 2.0)
    assert len(transforms(client)) == 2 == len(transforms(other))


async def test_the_time_that_is_spent_is_that_of_looking_up_and_each_client_pays_its_part(
    stage: Stage, client: Socketless, monkeypatch: pytest.MonkeyPatch
):
    await stage.begin(client)
    send_goal(stage.robot.bench.client())
    now_s = 0.0
    look = Buffer.lookup

    def slow(*about: Any) -> Any:
        nonlocal now_s
        now_s += 0.001
        return look(*about)

    spent_s: list[float] = []
    client.turns.spend = lambda seconds, _: spent_s.append(seconds) is None
    monkeypatch.setattr(Buffer, "lookup", slow)
    monkeypatch.setattr(republications.time, "monotonic", lambda: now_s)
    await stage.drive(2, 2.0)
    assert sum(spent_s) == pytest.approx(0.001)


async def test_a_refused_request_leaves_nothing_behind(bench: Bench, client: Socketless):
    def refuse(*_: Any) -> Any:
        raise RosError("internal", "no room")

    bench.ros.subscribe = refuse  # type: ignore[method-assign]
    send_goal(client)
    [result] = client.of("action_result")
    assert result["values"] == "no room"
    assert bench.router.counts()["transforms"] == 0
    assert len(client.session.outbox._queues) == 0
