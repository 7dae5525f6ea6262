# SPDX-License-Identifier: Apache-2.0
"""Operations on command topics, down to what ROS, the guard and the client get."""

import asyncio
import json
import math
import time
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from gateway.access.permissions import Identity, Policy
from gateway.config.access import AccessConfig, OperatorConfig
from gateway.core.commands import command_topic, commands, drive_timer
from gateway.core.commands.clients import Driver
from gateway.core.commands.command_topic import COMMAND_QOS
from gateway.drive import twist_cdr
from gateway.drive.drive import Drive
from gateway.sources.source import Qos, RosError
from tests.client import eventually
from tests.clock import StoppedClock
from tests.core.commands.conftest import STAMPED, TWIST, Build, Scene, push, speeds, stopped
from tests.core.conftest import Socketless
from tests.sources.fake_services import FakeService

Failures = Callable[[], int]


def is_tripped(client: Socketless) -> bool:
    """Ask whether commands to move are refused until a zero resets the latch."""
    client.send(op="control", topic="/cmd_vel")
    return bool(client.of("control")[-1]["tripped"])


@pytest.fixture
async def clock(monkeypatch: pytest.MonkeyPatch) -> StoppedClock:
    """Stop the time of the command topics with that of the loop."""
    clock, loop = StoppedClock(monkeypatch), asyncio.get_running_loop()
    stopped = SimpleNamespace(monotonic_ns=lambda: round(loop.time() * 1e9))
    for module in (command_topic, commands, drive_timer):
        monkeypatch.setattr(module, "time", stopped)
    return clock


async def test_a_command_reaches_the_robot_and_its_end_stops_it(scene: Scene):
    heard = scene.listen()
    client = scene.client()
    push(client)
    await eventually(lambda: speeds(heard) == [0.2])
    await eventually(lambda: len(heard) == 6)
    assert speeds(heard)[1:] == [0.0] * 5
    assert client.frames == []
    assert scene.guard.verbs[0] == "open"
    assert scene.guard.verbs[-1] == "rest"


async def test_control_that_was_asked_for_delays_neither_the_deadline_nor_the_zeros(
    scene: Scene, clock: StoppedClock
):
    heard = scene.listen()
    client = scene.sender(op="acquire_control")
    push(client)
    await clock.advance(0.49)
    assert speeds(heard) == [0.2]
    await clock.advance(0.02)
    assert speeds(heard) == [0.2, 0.0]
    for _ in range(4):
        await clock.advance(0.051)
    assert speeds(heard) == [0.2] + [0.0] * 5


async def test_a_turn_that_fails_does_not_stop_the_time_of_the_next_ones(
    scene: Scene, clock: StoppedClock, monkeypatch: pytest.MonkeyPatch
):
    errors: list[object] = []
    asyncio.get_running_loop().set_exception_handler(lambda _, context: errors.append(context))
    heard = scene.listen()
    client = scene.client()
    with monkeypatch.context() as broken:
        broken.setattr(Drive, "end_turn", lambda *_: 1 // 0)
        push(client)
        await clock.advance(0.01)
    assert len(errors) == 1
    push(client, 0.1)
    await clock.advance(0.01)
    assert speeds(heard) == [0.1]


@pytest.fixture
def failing(monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture) -> Failures:
    """Make topics of `STAMPED` fail by a bug. Return a count of how often it is logged."""

    def encode(type_name: str, *rest: Any) -> bytes:
        if type_name == STAMPED:
            raise ZeroDivisionError
        return twist_cdr.encode(type_name, *rest)

    monkeypatch.setattr(command_topic, "encode", encode)
    return lambda: sum("ZeroDivisionError" in (each.exc_text or "") for each in caplog.records)


@pytest.mark.parametrize(
    "stop",
    [
        lambda scene, client: scene.router.stop_robots(),
        lambda scene, client: scene.router.revoke(client.session),
        lambda scene, client: scene.router.leave(client.session),
        lambda scene, client: scene.router.close(),
        lambda scene, client: client.send(op="stop"),
    ],
    ids=["shutdown", "revoke", "leave", "close", "stop"],
)
async def test_a_bug_at_one_robot_keeps_nothing_back_at_another(
    build: Build, clock: StoppedClock, failing: Failures, stop: Callable[[Scene, Socketless], None]
):
    scene = build(topics=("/failing", "/cmd_vel"))
    scene.listen("/failing", STAMPED)
    heard = scene.listen()
    client = scene.client()
    for x in (0.2, 0.1):
        push(client, x)
        push_failing(client)
        await clock.advance(0.01)
    assert failing() == 2
    assert speeds(heard) == [0.2, 0.1]
    stop(scene, client)
    await clock.advance(0.01)
    assert speeds(heard)[:3] == [0.2, 0.1, 0.0]
    assert failing() >= 3


async def test_a_stop_that_fails_on_its_way_is_tried_again_and_left_to_the_guard(
    scene: Scene, clock: StoppedClock, monkeypatch: pytest.MonkeyPatch
):
    heard = scene.listen()
    client = scene.client()

    async def stop() -> None:
        client.send(op="stop")
        for _ in range(6):
            await clock.advance(0.051)

    push(client)
    await clock.advance(0.01)
    with monkeypatch.context() as broken:
        broken.setattr(command_topic, "encode", lambda *_: 1 // 0)
        await stop()
    assert speeds(heard) == [0.2]
    assert scene.guard.verbs == ["open", *["moving"] * 6]  # but no rest
    await stop()
    assert speeds(heard) == [0.2] + [0.0] * 5
    assert scene.guard.verbs[-1] == "rest"


async def test_a_stop_that_ros_refuses_is_left_to_the_guard_also_at_the_end(
    scene: Scene, clock: StoppedClock, monkeypatch: pytest.MonkeyPatch
):
    def refuse(*_: object) -> None:
        raise RosError("internal", "no")

    scene.listen()
    push(scene.client())
    await clock.advance(0.01)
    monkeypatch.setattr(scene.ros.publishers[0], "publish", refuse)
    scene.router.close()
    assert scene.guard.verbs[-1] == "moving"
    assert not {"rest", "close"} & set(scene.guard.verbs)


def push_failing(client: Socketless) -> None:
    client.send(op="publish", topic="/failing", msg={"twist": {"linear": {"x": 0.2}}})


async def test_a_driver_hears_of_a_robot_that_no_command_reaches(scene: Scene):
    watcher = scene.sender(op="events")
    client = scene.sender(op="advertise", topic="/cmd_vel", type=TWIST)
    latched = Qos("reliable", "transient_local")
    scene.ros.add_subscription("/cmd_vel", TWIST, lambda _: None, latched)
    await eventually(lambda: bool(client.statuses))
    [(code, text)] = client.statuses
    assert code == "qos_incompatible"
    assert "/outside asks for durability transient_local, published is with durability" in text
    assert "the gateway never stores a command for later" in text
    scene.ros.add_subscription("/cmd_vel", "std_msgs/msg/String", lambda _: None, node="/other")
    await eventually(lambda: len(client.statuses) > 1)
    code, text = client.statuses[-1]
    assert code == "type_conflict"
    assert text.endswith("publish std_msgs/msg/String")
    assert [each["code"] for each in watcher.of("event")] == ["qos_incompatible", code]


async def test_a_robot_may_join_while_its_topic_is_opened(scene: Scene, monkeypatch):
    scene.listen()
    advertise = scene.ros.advertise

    def joined(*given: Any) -> Any:
        scene.listen()
        return advertise(*given)

    monkeypatch.setattr(scene.ros, "advertise", joined)
    client = scene.client()
    push(client)
    assert scene.guard.verbs[:2] == ["open", "open"]
    assert len(scene.ros.publishers) == 1


async def test_the_guard_hears_of_a_command_before_it_goes_out(scene: Scene):
    client = scene.sender(op="advertise", topic="/cmd_vel", type=TWIST)
    (publisher,) = scene.ros.publishers
    publisher.publish = lambda cdr: scene.guard.told.append(("publish", cdr))  # type: ignore[method-assign]
    push(client)
    await eventually(lambda: "publish" in scene.guard.verbs)
    assert scene.guard.verbs[:3] == ["open", "moving", "publish"]
    await eventually(lambda: "rest" in scene.guard.verbs)
    assert scene.guard.verbs[3:] == ["moving", "publish"] * 5 + ["rest"]


async def test_a_guard_that_is_found_lost_while_a_command_goes_out_keeps_it_back(scene: Scene):
    heard = scene.listen()
    scene.guard.on_moving = lambda: scene.guard.report("lost")
    client = scene.client()
    push(client)
    await eventually(lambda: len(heard) >= 1)
    assert set(speeds(heard)) == {0.0}
    push(client)
    assert client.statuses[-1][0] == "tripped"
    assert "the guard process, without which nothing moves, ended or hung" in client.statuses[-1][1]


async def test_a_gateway_that_stood_still_within_a_command_keeps_it_back(build: Build):
    scene = build(deadline_s=0.1)
    heard = scene.listen()
    scene.guard.on_moving = lambda: time.sleep(0.11)
    client = scene.client()
    push(client)
    await eventually(lambda: len(heard) >= 1)
    assert set(speeds(heard)) == {0.0}


async def test_the_guard_prepares_for_a_robot_before_a_client_drives_it(scene: Scene):
    scene.listen()
    await eventually(lambda: bool(scene.guard.told))
    assert scene.guard.told == [("open", "/cmd_vel", TWIST, 1)]
    client = scene.sender(op="control")
    assert client.of("control")[0]["guard"] == "ready"
    push(client)
    assert scene.guard.verbs.count("open") == 1
    assert len([each for each in scene.ros.publishers if each.topic == "/cmd_vel"]) == 1


async def test_the_guard_prepares_for_each_robot_before_a_client_drives(scene: Scene):
    scene.listen()
    await eventually(lambda: scene.guard.verbs == ["open"])
    scene.listen()
    await eventually(lambda: scene.guard.verbs == ["open", "open"])
    assert scene.guard.told[-1] == ("open", "/cmd_vel", TWIST, 2)


async def test_the_guard_prepares_for_no_type_that_moves_nothing(scene: Scene):
    robot = scene.ros.add_subscription("/cmd_vel", "std_msgs/msg/String", lambda samples: None)
    await scene.settle()
    robot.close()
    scene.listen()
    await eventually(lambda: bool(scene.guard.told))
    assert scene.guard.told == [("open", "/cmd_vel", TWIST, 1)]


async def test_the_guard_follows_another_type(scene: Scene):
    robot = scene.ros.add_subscription("/cmd_vel", TWIST, lambda samples: None)
    await eventually(lambda: scene.guard.verbs == ["open"])
    robot.close()
    scene.listen(type_name=STAMPED)
    await eventually(lambda: scene.guard.verbs == ["open", "close", "open"])
    assert scene.guard.told[-1] == ("open", "/cmd_vel", STAMPED, 1)


async def test_the_publisher_is_reliable_and_keeps_one_command_for_a_moment(scene: Scene):
    scene.listen()
    client = scene.sender(op="advertise", topic="/cmd_vel", type=TWIST, latch=True, queue_size=50)
    (publisher,) = [each for each in scene.ros.publishers if each.topic == "/cmd_vel"]
    assert publisher.qos.reliability == COMMAND_QOS.reliability == "reliable"
    assert publisher.qos.durability == "volatile"
    assert publisher.qos.depth == 1
    assert publisher.qos.lifespan_ns == 250_000_000
    assert client.statuses == [
        ("bad_request", "latch is ignored: a command topic stores no message for later subscribers")
    ]


@pytest.mark.parametrize(
    ("linear", "where", "got"),
    [
        ({"x": None}, "linear.x", "null"),
        ({"z": None}, "linear.z", "null"),
        ({"x": "NaN"}, "linear.x", "NaN"),
        ({"y": "-Infinity"}, "linear.y", "-Infinity"),
        ({"x": math.inf}, "linear.x", "Infinity"),
    ],
)
async def test_a_speed_that_is_not_finite_is_refused_and_stops_a_robot_that_moves(
    scene: Scene, linear, where: str, got: str
):
    client, heard = await scene.driven()
    client.send(op="publish", topic="/cmd_vel", msg={"linear": linear})
    code, text = client.statuses[-1]
    assert code == "invalid_value"
    assert text == f"msg.{where}: expected a finite number, got {got}"
    await stopped(heard)


async def test_a_speed_beyond_the_limit_is_clamped_and_the_client_told(build: Build):
    scene = build(max_linear_m_s=0.5)
    heard = scene.listen()
    client, watcher = scene.client(), scene.client()
    push(client, 1e308)
    await eventually(lambda: speeds(heard)[:1] == [0.5])
    assert client.statuses == [
        ("invalid_value", "topic /cmd_vel: too fast, clamped to 0.5 m/s and 10 rad/s")
    ]
    watcher.send(op="acquire_control", topic="/cmd_vel")
    watcher.send(op="publish", topic="/cmd_vel", msg={})
    await eventually(lambda: not is_tripped(watcher))
    push(watcher, 7)
    assert watcher.of("control")[-1]["clamped"] is True


async def test_a_turn_beyond_the_limit_is_clamped_and_the_client_told(
    build: Build, clock: StoppedClock
):
    scene = build(max_angular_rad_s=0.25)
    heard = scene.listen()
    client = scene.sender(op="publish", topic="/cmd_vel", msg={"angular": {"z": 7}})
    await clock.advance(0.01)
    assert [each["angular"]["z"] for each in heard] == [0.25]
    (status,) = client.statuses
    assert status == ("invalid_value", "topic /cmd_vel: too fast, clamped to 10 m/s and 0.25 rad/s")


async def test_if_the_first_command_must_be_zero_nothing_moves_before_it(
    build: Build, clock: StoppedClock
):
    scene = build(first_command="zero")
    heard = scene.listen()
    client = scene.client()
    push(client)
    await clock.advance(0.01)
    assert heard == []
    [(code, text)] = client.statuses
    assert code == "tripped"
    assert "this gateway needs a zero command before the first command to move" in text


async def test_a_driver_keeps_others_out_for_the_configured_lease(
    build: Build, clock: StoppedClock
):
    scene = build(lease_s=5)
    scene.listen()
    driver, other = scene.client(), scene.client()
    push(driver)
    for seconds, holder in ((4.9, "other"), (0.2, None)):
        await clock.advance(seconds)
        other.send(op="control")
        assert other.of("control")[-1]["holder"] == holder


async def test_a_client_that_leaves_stops_the_robot_and_leaves_nothing_open(scene: Scene):
    client, heard = await scene.driven()
    scene.router.leave(client.session)
    await stopped(heard)
    assert scene.ros.entity_count() == 0
    assert scene.guard.verbs[-1] == "rest"
    assert scene.router.counts()["publishers"] == 0


async def test_a_robot_stops_before_anything_else_of_its_driver_is_closed(
    scene: Scene, monkeypatch: pytest.MonkeyPatch
):
    published: list[int] = []
    close = FakeService.close

    def note(service: FakeService) -> None:
        published.append(scene.ros.published)
        close(service)

    monkeypatch.setattr(FakeService, "close", note)
    scene.listen()
    client = scene.sender(op="advertise_service", service="/s", type="std_srvs/srv/Trigger")
    push(client)
    await scene.settle()
    assert scene.ros.published == 1
    scene.router.leave(client.session)
    assert published == [2]  # the zero is counted as well


async def test_a_client_that_stops_what_stands_and_leaves_leaves_nothing_open(scene: Scene):
    heard = scene.listen()
    client = scene.sender(op="advertise", topic="/cmd_vel", type=TWIST)
    client.send(op="stop", topic="/cmd_vel")
    scene.router.leave(client.session)  # while its zeros are still to be sent
    assert scene.router.counts()["publishers"] == 1
    await eventually(lambda: scene.router.counts()["publishers"] == 0)
    assert set(speeds(heard)) == {0.0}
    assert scene.ros.entity_count() == 0


async def test_a_stopped_robot_stays_stopped_for_a_client_that_comes_back(scene: Scene):
    heard = scene.listen()
    client = scene.client()
    push(client)
    await scene.settle()
    push(client)
    await eventually(lambda: len(heard) == 2)
    scene.router.leave(client.session)
    again = scene.client()
    push(again, id=1)
    assert again.statuses[0][0] == "tripped"
    again.send(op="publish", topic="/cmd_vel", msg={})
    await eventually(lambda: not is_tripped(again))
    push(again, 0.1)
    await eventually(lambda: speeds(heard)[-1] == 0.1)


async def test_a_client_that_leaves_while_it_is_refused_is_forgotten(scene: Scene):
    scene.listen()
    driver, other = scene.client(), scene.client()
    push(driver)
    push(other)
    refused = scene.router.commands._topics["/cmd_vel"]._drive._refused_drivers
    assert len(refused) == 1
    scene.router.leave(other.session)
    assert len(refused) == 0


def test_an_answer_is_due_again_after_exactly_a_second():
    driver = Driver()
    assert [driver.is_due("tripped", now_ns) for now_ns in (0, 999_999_999, 1_000_000_000)] == [
        *(True, False, True)
    ]


async def test_a_refused_stream_is_answered_once_a_second_but_always_with_an_id(scene: Scene):
    scene.listen()
    driver, other = scene.client(), scene.client()
    push(driver)
    for _ in range(10):
        push(other)
    assert [code for code, _ in other.statuses] == ["not_lease_holder"]
    push(other, id="q")
    assert other.of("status")[-1]["id"] == "q"
    assert other.session.refused == 11


async def test_any_client_may_stop_every_robot(scene: Scene):
    heard = scene.listen()
    driver, other = scene.client(), scene.client()
    push(driver)
    await eventually(lambda: len(heard) == 1)
    other.send(op="stop", id="s")
    assert other.of("stop") == [{"op": "stop", "id": "s", "topics": ["/cmd_vel"]}]
    await eventually(lambda: len(heard) == 6)
    push(driver)
    assert driver.statuses[-1][0] == "tripped"
    assert "another client asked for a stop" in driver.statuses[-1][1]


async def test_a_stop_without_a_driver_is_published_if_the_robot_is_known(build: Build):
    scene = build(topics=("/cmd_vel", "/arm"))
    heard = scene.listen()
    client = scene.sender(op="stop")
    assert client.of("stop")[0]["topics"] == ["/cmd_vel"]
    await eventually(lambda: speeds(heard) == [0.0] * 5)
    client.send(op="stop", topic="/odom")
    assert client.statuses == [
        ("not_found", "/odom is not a command topic: use one of /cmd_vel, /arm")
    ]


async def test_control_is_taken_held_and_given_back(scene: Scene):
    heard = scene.listen()
    one, two = scene.client(), scene.client()
    push(one)
    await eventually(lambda: len(heard) == 1)
    two.send(op="acquire_control", id=1)
    answer = two.of("acquire_control")[0]
    assert answer["id"] == 1
    assert (answer["holder"], answer["tripped"], answer["cause"]) == ("you", True, "takeover")
    one.send(op="control", topic="cmd_vel")
    assert one.of("control")[0]["holder"] == "other"
    assert [drive.is_leased for drive in scene.router.control().drives] == [True]
    two.send(op="release_control")
    assert two.of("release_control")[0]["holder"] is None
    assert [drive.is_leased for drive in scene.router.control().drives] == [False]


async def test_control_is_taken_over_once_a_second_at_most(scene: Scene, clock: StoppedClock):
    scene.listen()
    first, second = scene.client(), scene.client()
    first.send(op="advertise", topic="/cmd_vel", type=TWIST)
    first.send(op="acquire_control")
    second.send(op="acquire_control")
    await clock.advance(0.98)
    first.send(op="acquire_control")
    code, text = first.statuses[-1]
    assert code == "limit_exceeded"
    assert "taken over less than 1 s ago: try again" in text
    await clock.advance(0.03)
    first.send(op="acquire_control")
    assert len(first.of("acquire_control")) == 2


async def test_a_watcher_gets_the_changes_and_no_more_after_it_has_ended_it(scene: Scene):
    heard = scene.listen()
    driver, watcher = scene.client(), scene.client()
    watcher.send(op="control", id="w", watch=True)
    assert watcher.of("control")[0]["state"] == "stopped"
    push(driver)
    await eventually(lambda: any(f["state"] == "moving" for f in watcher.of("control")))
    await eventually(lambda: len(heard) == 6)
    await eventually(lambda: watcher.of("control")[-1]["state"] == "stopped")
    assert watcher.of("control")[-1]["cause"] == "deadline"
    watcher.send(op="control", watch=False)
    count = len(watcher.of("control"))
    push(driver)
    await eventually(lambda: len(heard) == 12)
    assert len(watcher.of("control")) == count
    assert driver.frames == []


async def test_a_watcher_that_has_left_gets_nothing_more(scene: Scene, clock: StoppedClock):
    scene.listen()
    driver, gone, watcher = scene.client(), scene.client(), scene.client()
    for each in (gone, watcher):
        each.send(op="control", watch=True)
    scene.router.leave(gone.session)
    count = len(gone.frames)
    push(driver)
    await clock.advance(0.01)
    await clock.advance(0.5)
    await clock.advance(0.051)  # its notice
    assert watcher.of("control")[-1]["cause"] == "deadline"
    assert len(gone.frames) == count


async def test_a_watcher_gets_one_notice_of_what_changes_within_50_ms(
    scene: Scene, monkeypatch: pytest.MonkeyPatch
):
    clock = StoppedClock(monkeypatch)
    scene.listen()
    client, watcher = scene.client(), scene.client()
    watcher.send(op="control", watch=True)
    await clock.advance(1)  # the guard has answered
    watcher.frames.clear()
    for _ in range(8):
        client.send(op="acquire_control")
        client.send(op="release_control")
        await clock.advance(0.005)
    await clock.advance(0.009)
    assert watcher.of("control") == []
    await clock.advance(0.002)
    assert [frame["holder"] for frame in watcher.of("control")] == [None]


async def test_the_only_command_topic_need_not_be_named_but_one_of_several(build: Build):
    scene = build(topics=("/a", "/b"))
    client = scene.sender(op="control")
    assert client.statuses == [("bad_request", "topic: name one of /a, /b")]


async def test_a_stamped_command_is_stamped_by_the_gateway_and_so_is_its_zero(scene: Scene):
    heard = scene.listen(type_name=STAMPED)
    client = scene.client()
    stamp = {"sec": 5, "nanosec": 0}
    client.send(
        op="publish",
        topic="/cmd_vel",
        msg={"header": {"frame_id": "base", "stamp": stamp}, "twist": {"linear": {"x": 0.1}}},
    )
    await eventually(lambda: len(heard) == 6)
    assert [each["twist"]["linear"]["x"] for each in heard] == [0.1, 0, 0, 0, 0, 0]
    assert {each["header"]["frame_id"] for each in heard} == {"base"}
    assert all(each["header"]["stamp"]["sec"] == 1_700_000_000 for each in heard)
    assert ("moving", "/cmd_vel", "base") in scene.guard.told


async def test_other_types_and_other_than_the_robots_are_refused(scene: Scene):
    client = scene.sender(op="advertise", topic="/cmd_vel", type="std_msgs/msg/String")
    assert client.statuses[-1][0] == "type_conflict"
    assert "control.topics" in client.statuses[-1][1]
    push(client)
    assert client.statuses[-1][0] == "not_found"
    scene.listen()
    client.send(op="publish", topic="/cmd_vel", type=STAMPED, msg={})
    assert client.statuses[-1] == (
        "type_conflict",
        f"topic /cmd_vel has type {TWIST}, not {STAMPED}",
    )
    push(client)
    client.send(op="publish", topic="/cmd_vel", type=STAMPED, msg={})
    assert client.statuses[-1][0] == "type_conflict"
    assert scene.ros.entity_count() == 1


async def test_the_first_command_is_an_advertisement_with_its_id(scene: Scene):
    client = scene.client()
    for number in (1, 2):
        client.send(op="publish", topic="/cmd_vel", type=TWIST, id=number, msg={})
    client.send(op="unadvertise", topic="/cmd_vel", id=2)
    assert client.statuses == [("not_found", "not advertised: /cmd_vel with id 2")]
    client.send(op="unadvertise", topic="/cmd_vel", id=1)
    assert len(client.statuses) == 1


async def test_unadvertising_stops_as_asked(scene: Scene):
    heard = scene.listen()
    client = scene.sender(op="advertise", topic="/cmd_vel", type=TWIST, id="a")
    push(client)
    await eventually(lambda: len(heard) == 1)
    client.send(op="unadvertise", topic="/cmd_vel", id="b")
    assert client.statuses == [("not_found", "not advertised: /cmd_vel with id 'b'")]
    client.send(op="unadvertise", topic="/cmd_vel")
    client.send(op="unadvertise", topic="/cmd_vel")
    assert client.statuses[-1] == ("not_found", "not advertised: /cmd_vel")
    await stopped(heard)
    push(client)
    await eventually(lambda: speeds(heard)[-1] == 0.2)


@pytest.mark.parametrize(
    ("is_behind", "why"),
    [(True, "(limits.client_time_share): send less"), (False, "the gateway was busy: send it")],
)
async def test_a_command_that_waited_is_stale_and_hears_why(
    scene: Scene, why: str, *, is_behind: bool
):
    client, heard = await scene.driven()
    client.turns.waited_s = lambda: 0.25
    client.turns.is_behind = is_behind
    push(client)
    code, text = client.statuses[-1]
    assert code == "stale_command"
    assert why in text
    await eventually(lambda: speeds(heard)[1:2] == [0.0])  # the deadline


async def test_a_command_that_a_stop_has_overtaken_does_not_move_the_robot(scene: Scene):
    client, heard = await scene.driven()
    client.send(op="stop")
    client.turns.is_overtaken = True
    push(client, monotonic_ms=time.monotonic_ns() / 1e6)
    push(client, 0.0)
    assert [code for code, _ in client.statuses] == ["stale_command"]
    await eventually(lambda: len(heard) == 6)
    client.turns.is_overtaken = False
    push(client)
    await eventually(lambda: speeds(heard) == [0.2, *[0.0] * 5, 0.2])


async def test_a_client_that_has_control_drives(scene: Scene):
    scene.listen()
    one, two = scene.client(), scene.client()
    assert not one.session.drives
    push(one)
    assert (one.session.drives, two.session.drives) == (True, False)
    two.send(op="acquire_control")
    assert (one.session.drives, two.session.drives) == (False, True)


async def test_a_stale_command_is_told_by_the_clients_clock(scene: Scene):
    heard = scene.listen()
    client = scene.client()
    sent_ms = time.monotonic_ns() / 1e6
    push(client, monotonic_ms=sent_ms)
    await eventually(lambda: len(heard) == 1)
    push(client, monotonic_ms=sent_ms - 300)
    code, text = client.statuses[-1]
    assert code == "stale_command"
    assert "by its monotonic_ms" in text


@pytest.mark.parametrize("x", [0.0, 0.2])
async def test_the_time_that_it_takes_to_open_the_topic_makes_a_first_command_no_older(
    scene: Scene, clock: StoppedClock, monkeypatch: pytest.MonkeyPatch, x: float
):
    heard, client = scene.listen(), scene.client()
    loop, advertise = asyncio.get_running_loop(), scene.ros.advertise
    read_s = loop.time()
    client.turns.waited_s = lambda: loop.time() - read_s

    def open_slowly(*arguments: Any) -> Any:
        clock.jump(0.6)
        return advertise(*arguments)

    monkeypatch.setattr(scene.ros, "advertise", open_slowly)
    push(client, x)
    assert client.statuses == []
    await clock.advance(0.01)
    assert speeds(heard) == [x]
    await clock.advance(0.48)
    assert speeds(heard) == [x]


async def test_a_shutdown_stops_at_once_and_nothing_moves_after(scene: Scene):
    client, heard = await scene.driven()
    scene.router.stop_robots()
    await eventually(lambda: speeds(heard)[1:2] == [0.0])
    push(client, id=1)
    assert client.statuses[-1] == ("tripped", "topic /cmd_vel: the gateway is shutting down")


async def test_a_router_that_closes_in_the_middle_of_a_motion_sends_a_zero(build: Build):
    scene = build()
    heard = scene.listen()
    push(scene.client())
    await eventually(lambda: len(heard) == 1)
    scene.router.close()
    await eventually(lambda: 0.0 in speeds(heard))
    assert scene.guard.verbs[-2:] == ["rest", "close"]


async def test_a_router_that_closes_refuses_a_command_that_waits(build: Build):
    scene = build()
    scene.listen()
    scene.guard.is_ready = False
    client = scene.client()
    push(client, id=1)
    await scene.settle()
    scene.router.close()
    assert client.statuses[-1] == ("tripped", "topic /cmd_vel: the gateway is shutting down")


async def test_without_command_topics_a_twist_is_a_message_like_any_other(build: Build):
    scene = build(topics=())
    heard = scene.listen()
    push(scene.client(), 1e3)
    await eventually(lambda: speeds(heard) == [1e3])
    assert scene.guard.told == []


async def test_a_robot_that_comes_up_while_the_stick_is_pushed_does_not_move(scene: Scene):
    client = scene.client()
    push(client, type=TWIST)
    await scene.settle()
    scene.guard.is_ready = False
    heard = scene.listen()
    await eventually(lambda: ("open", "/cmd_vel", TWIST, 1) in scene.guard.told)
    push(client, id=1)
    assert client.statuses[-1][0] == "tripped"
    await eventually(lambda: len(heard) >= 3)
    assert set(speeds(heard)) == {0.0}


@pytest.mark.parametrize("is_clean", [True, False], ids=["clean", "crashed"])
@pytest.mark.parametrize("others", [0, 1, 3])
@pytest.mark.parametrize("is_reported", [True, False], ids=["reported", "unreported"])
async def test_a_robot_that_restarts_while_the_stick_is_pushed_does_not_move(
    scene: Scene, others: int, monkeypatch, *, is_clean: bool, is_reported: bool
):
    for _ in range(others):
        scene.listen()
    robot = scene.ros.add_subscription("/cmd_vel", TWIST, lambda _: None)
    client = scene.client()
    push(client)
    await scene.settle()
    if is_clean:
        robot.close()
    if not is_reported:  # by the graph, only by the publisher
        monkeypatch.setattr(scene.ros, "changed", lambda: None)
    heard = scene.listen()
    if is_reported:
        await eventually(lambda: scene.guard.verbs.count("open") == 2)
    push(client)
    await eventually(lambda: len(heard) >= 3)
    assert set(speeds(heard)) == {0.0}
    assert scene.guard.told[-1][0] != "open"
    opened = [told for told in scene.guard.told if told[0] == "open"]
    assert opened[1:] == [("open", "/cmd_vel", TWIST, others + 2 - is_clean)]
    push(client, id=1)
    code, text = client.statuses[-1]
    assert code == "tripped"
    assert "another node began to listen" in text


async def test_a_robot_that_is_found_while_a_command_goes_out_hears_a_zero_at_once(
    scene: Scene, monkeypatch
):
    client = scene.client()
    push(client, type=TWIST)
    await scene.settle()
    monkeypatch.setattr(scene.ros, "changed", lambda: None)  # the graph reports nothing
    [publisher] = [each for each in scene.ros.publishers if each.topic == "/cmd_vel"]
    publish, heard = publisher.publish, []

    def join_and_publish(cdr: bytes) -> None:
        monkeypatch.setattr(publisher, "publish", publish)
        heard.append(scene.listen())
        publish(cdr)

    monkeypatch.setattr(publisher, "publish", join_and_publish)
    push(client)
    await eventually(lambda: bool(heard) and 0.0 in speeds(heard[0]))
    assert speeds(heard[0])[:2] == [0.2, 0.0]
    client.send(op="control")
    assert client.of("control")[0]["cause"] == "reader"


async def test_a_page_that_shows_the_commands_does_not_stop_the_robot(scene: Scene):
    heard = scene.listen()
    client = scene.client()
    push(client)
    await scene.settle()
    scene.client().send(op="subscribe", topic="/cmd_vel")
    await scene.settle()
    push(client, 0.1)
    await eventually(lambda: speeds(heard)[:2] == [0.2, 0.1])
    assert scene.guard.verbs.count("open") == 1


async def test_a_command_waits_until_the_guard_has_proved_that_its_zeros_arrive(scene: Scene):
    heard = scene.listen()
    scene.guard.is_ready = False
    client = scene.sender(op="advertise", topic="/cmd_vel", type=TWIST)
    scene.guard.report("prepared")
    assert "prove" not in scene.guard.verbs
    client.send(op="control")
    assert client.of("control")[-1]["guard"] == "ready"
    push(client)
    assert scene.guard.verbs[-1] == "prove"
    await scene.settle()
    assert heard == []
    scene.guard.report("ready")
    await eventually(lambda: speeds(heard)[:1] == [0.2])


async def test_a_client_that_lost_the_permission_to_drive_is_stopped(scene: Scene):
    client, heard = await scene.driven()
    scene.router.revoke(client.session)
    await eventually(lambda: speeds(heard)[1:2] == [0.0])
    push(client, id=1)
    assert client.statuses[-1][0] == "tripped"
    assert "the permission to drive ended" in client.statuses[-1][1]
    assert [each["cause"] for each in scene.audited if each["event"] == "stop"] == ["permission"]


def of_role(scene: Scene, role: str, name: str = "?", **access: object) -> Socketless:
    config = AccessConfig(**access)
    return scene.client(identity=Identity("tablet", Policy(config).of(role)), name=name)


async def test_lines_of_the_audit_log_have_their_client(scene: Scene, caplog):
    caplog.set_level("INFO", "gateway.audit")
    scene.listen()
    client = of_role(scene, "viewer", "10.0.0.5#7")
    push(client)
    other = of_role(scene, "operator", "10.0.0.5#8")
    push(other)
    await eventually(lambda: len(scene.audited) == 3)
    records = [each for each in caplog.records if each.name == "gateway.audit"]
    assert [(json.loads(each.getMessage())["event"], each.client) for each in records] == [
        ("forbidden", "10.0.0.5#7"),
        ("control_taken", "10.0.0.5#8"),
        ("stop", "10.0.0.5#8"),
    ]


async def test_the_audit_log_has_each_change_of_control_and_each_stop(scene: Scene):
    scene.listen()
    client = of_role(scene, "operator")
    push(client)
    await eventually(lambda: len(scene.audited) == 2)
    who = {"topic": "/cmd_vel", "name": "tablet", "role": "operator"}
    taken, stop = ({k: v for k, v in event.items() if k != "address"} for event in scene.audited)
    assert taken == {"event": "control_taken", **who}
    assert stop == {"event": "stop", "cause": "deadline", "tripped": False, **who}
    client.send(op="release_control")
    push(client)
    await eventually(lambda: "control_taken" in [each["event"] for each in scene.audited[2:]])


async def test_the_clock_of_a_driver_is_known(scene: Scene):
    client = scene.client()
    client.send(op="ping", clock_offset_ms=-12.5)
    client.send(op="advertise", topic="/cmd_vel", type=TWIST)
    client.send(op="acquire_control", topic="/cmd_vel")
    assert scene.router.control().drives[0].clock_offset_ms == -12.5
    (taken,) = (each for each in scene.audited if each["event"] == "control_taken")
    assert taken["clock_offset_ms"] == -12.5


async def test_a_viewer_stops_a_robot_but_takes_no_control(scene: Scene):
    heard = scene.listen()
    driver, viewer = scene.client(), of_role(scene, "viewer")
    push(driver)
    await eventually(lambda: speeds(heard) == [0.2])
    viewer.send(op="acquire_control", id=1)
    assert viewer.statuses == [
        (
            "forbidden",
            "publishing on /cmd_vel requires role operator or admin, and this client is viewer",
        )
    ]
    viewer.send(op="stop", id=2)
    assert viewer.of("stop") == [{"op": "stop", "id": 2, "topics": ["/cmd_vel"]}]
    await eventually(lambda: 0.0 in speeds(heard))
    (stop,) = (each for each in scene.audited if each["event"] == "stop")
    (asked,) = (each for each in scene.audited if each["event"] == "stop_requested")
    assert (stop["cause"], stop["role"]) == ("stop", "admin")
    assert (asked["topic"], asked["role"]) == ("/cmd_vel", "viewer")


async def test_a_hidden_command_topic_does_not_exist(build: Build):
    scene = build(topics=("/cmd_vel", "/secret"))
    scene.listen("/secret")
    hidden = {f"deny_{action}": ("/secret",) for action in ("subscribe", "publish", "call")}
    client = of_role(scene, "operator", operator=OperatorConfig(**hidden))
    client.send(op="control", topic="/secret")
    assert client.statuses == [
        ("not_found", "/secret is not a command topic: use one of /cmd_vel"),
    ]
    client.send(op="control")
    assert [each["topic"] for each in client.of("control")] == ["/cmd_vel"]
    client.send(op="stop")
    assert [each["topics"] for each in client.of("stop")] == [[]]
