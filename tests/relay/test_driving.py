# SPDX-License-Identifier: Apache-2.0
"""Clients of a relay drive as those of the robot's own gateway do, and notice no difference.

The relay's core and the robot's are both here, without Zenoh between them.
"""

import asyncio
import contextlib
from collections.abc import AsyncIterator, Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from types import SimpleNamespace
from typing import Any

import pytest

from gateway.access.permissions import UNLIMITED, Identity, Policy
from gateway.codec.types import Types
from gateway.config.access import AccessConfig
from gateway.core.commands.interface import OpenCommands
from gateway.core.requests import Publish
from gateway.core.router import Router
from gateway.relay import driver, driving_states
from gateway.relay import driving as relay_driving
from gateway.relay.command_sender import BEAT_S
from gateway.relay.driver import MAX_ASKED
from gateway.relay.driving import RemoteCommands
from gateway.relay.driving_states import MAX_QUESTIONS
from gateway.relay.robot_link import OnTold
from gateway.sources.zenoh.driving_wire import (
    Beat,
    RemoteCommand,
    RemoteOperation,
    RemoteStop,
    Told,
    ToldEvent,
    TopicControl,
    read_told,
)
from gateway.uplink.driving import RemoteDrivers
from schemas.installed import InstalledDefinitions
from schemas.table import Table
from tests.client import Frame, eventually
from tests.core.commands.conftest import (  # noqa: F401  # fixtures
    STAMPED,
    TWIST,
    Scene,
    build,
    push,
    scene,
    speeds,
)
from tests.core.conftest import LIMITS, Bench, Socketless
from tests.sources.fake import FakeRos


class DirectLink:
    """A link without a network: while it is cut, it holds back what is sent."""

    relay = "a1"

    def __init__(self, robot: Router, identity: Identity, commands: RemoteCommands) -> None:
        self.commands = commands
        self.robot = RemoteDrivers(robot, identity, self._tell)
        self.is_listening = False
        self.is_cut = False
        self.held: list[Callable[[], None]] = []
        self.sent: list[RemoteCommand] = []
        self.told: list[tuple[str, Told]] = []
        self._beating = asyncio.create_task(self._beat())

    async def _beat(self) -> None:
        while True:
            self.robot.tick()
            if self.is_listening and not self.is_cut:
                self.commands.hear_beat(self.robot.beat)
            await asyncio.sleep(0.02)

    def _tell(self, client: str, data: bytes) -> None:
        told = read_told(data)
        self.told.append((client, told))
        if self.is_listening and not self.is_cut:
            self.commands.hear(client, told)

    def _go(self, work: Callable[[], None]) -> None:
        if self.is_cut:
            self.held.append(work)
        else:
            asyncio.get_running_loop().call_soon(work)

    def come_back(self) -> None:
        self.is_cut = False
        for work in self.held:
            work()
        self.held.clear()

    def ask(self, operation: RemoteOperation | RemoteStop, on_told: OnTold) -> None:
        is_stop = isinstance(operation, RemoteStop)
        carry_out = self.robot.stop if is_stop else self.robot.operate
        self._go(lambda: on_told(read_told(carry_out(operation.packed))))

    def send(self, client: str, command: RemoteCommand) -> None:
        self.sent.append(command)
        self._go(lambda: self.robot.command(f"cmd/{client}", command.packed))

    def show(self, client: str) -> None:
        self._go(lambda: self.robot.follow_token(f"client/{client}", is_there=True))

    def hide(self, client: str) -> None:
        self._go(lambda: self.robot.follow_token(f"client/{client}", is_there=False))

    def listen(self, *, is_on: bool) -> None:
        self.is_listening = is_on

    def close(self) -> None:
        self._beating.cancel()
        self.robot.close()


class Fleet:
    """A robot with its gateway, and a relay."""

    def __init__(self, robot: Scene, relay: Bench, link: DirectLink) -> None:
        self.robot, self.relay, self.link = robot, relay, link
        self.heard = robot.listen()

    async def driven(self) -> Socketless:
        client = self.relay.client()
        push(client)
        await eventually(lambda: speeds(self.heard)[-1:] == [0.2])
        return client

    async def stopped(self) -> None:
        await eventually(lambda: speeds(self.heard)[-5:] == [0.0] * 5)

    @property
    def cause(self) -> str | None:
        [state] = self.link.robot.states()
        return state.members["cause"]  # type: ignore[no-any-return]


@contextlib.contextmanager
def open_relay_core(open_commands: OpenCommands) -> Iterator[Bench]:
    """Open the core of a relay, which has no guard."""
    with ThreadPoolExecutor(1) as workers:
        ros, types = FakeRos(), Types(InstalledDefinitions())
        router = Router(
            ros,
            types,
            Table.load(),
            limits=LIMITS,
            workers=workers,
            version="test",
            open_commands=open_commands,
        )
        yield Bench(ros, router, types)
        router.close()


@pytest.fixture
async def fleet(scene: Scene) -> AsyncIterator[Fleet]:  # noqa: F811
    links: list[DirectLink] = []

    def open_link(commands: RemoteCommands) -> DirectLink:
        links.append(DirectLink(scene.router, UNLIMITED, commands))
        return links[0]

    with open_relay_core(partial(RemoteCommands, ("/cmd_vel",), open_link)) as bench:
        yield Fleet(scene, bench, links[0])


SCRIPTS: dict[str, list[dict[str, Any]]] = {
    "control": [
        {"op": "acquire_control", "topic": "/cmd_vel", "id": 1},
        {"op": "control", "id": "2"},
        {"op": "release_control", "id": 3},
        {"op": "control", "topic": "/cmd_vel", "id": 4},
    ],
    "stop": [{"op": "stop", "id": 1}, {"op": "stop", "topic": "/cmd_vel", "id": 2}],
    "names": [
        {"op": "acquire_control", "topic": "/no", "id": 2},
        {"op": "control", "topic": "/no", "id": 3},
        {"op": "release_control", "topic": "a b", "id": 4},
    ],
    "types": [
        {"op": "advertise", "topic": "/cmd_vel", "type": "std_msgs/String", "id": 1},
        {"op": "advertise", "topic": "/cmd_vel", "type": "no/Type", "id": 2},
        {"op": "advertise", "topic": "/cmd_vel", "type": TWIST, "latch": True, "id": 3},
        {"op": "advertise", "topic": "/cmd_vel", "type": STAMPED, "id": 4},
        {"op": "unadvertise", "topic": "/cmd_vel", "id": 9},
        {"op": "unadvertise", "topic": "/cmd_vel", "id": 3},
    ],
    "values": [
        {"op": "publish", "topic": "/cmd_vel", "msg": {"linear": {"x": None}}, "id": 1},
        {"op": "publish", "topic": "/cmd_vel", "msg": {"linear": 7}, "id": 2},
        {"op": "publish", "topic": "/cmd_vel", "msg": {"linear": {"x": 99}}, "id": 3},
        {"op": "publish", "topic": "/cmd_vel", "msg": {}, "id": 4},
        {"op": "publish", "topic": "/cmd_vel", "type": STAMPED, "msg": {}, "id": 5},
    ],
}


def without_texts(frames: list[Frame]) -> list[Frame]:
    """Return frames without what differs from run to run."""
    return [{k: v for k, v in frame.items() if k not in {"state", "guard"}} for frame in frames]


async def said_to(client: Socketless, operations: list[dict[str, Any]]) -> list[Frame]:
    """Carry out operations one by one, and return everything that is answered."""
    for operation in operations:
        client.send(**operation)
        client.send(op="control", topic="/cmd_vel", id="mark")
        await client.sees_id("mark")
        await asyncio.sleep(0.3)  # for answers that come later
        client.frames[:] = [frame for frame in client.frames if frame.get("id") != "mark"]
    return without_texts(
        [each for each in client.frames if each["op"] != "control" or "id" in each]
    )


@pytest.mark.parametrize("name", SCRIPTS)
async def test_a_client_of_a_relay_gets_the_answers_of_the_robots_own(
    fleet: Fleet,
    build: Callable[..., Scene],  # noqa: F811
    name: str,
):
    direct = build()
    direct.listen()
    expected = await said_to(direct.client(), SCRIPTS[name])
    assert expected
    assert await said_to(fleet.relay.client(), SCRIPTS[name]) == expected


async def test_a_client_of_a_relay_drives_and_its_end_stops_the_robot(fleet: Fleet):
    client = await fleet.driven()
    await eventually(lambda: fleet.relay.router.is_driven_by(client.session))
    assert client.of("status") == []
    fleet.relay.router.leave(client.session)
    await fleet.stopped()
    assert fleet.cause == "disconnect"
    assert not fleet.link.is_listening


async def test_two_clients_of_a_relay_see_who_drives(fleet: Fleet):
    first = await fleet.driven()
    watching = fleet.relay.client()
    watching.send(op="control", watch=True, id=1)
    await watching.sees_id(1)
    await eventually(lambda: watching.of("control")[-1]["holder"] == "other")
    second = fleet.relay.client()
    push(second, id=7)
    await second.sees_id(7)
    assert second.of("status")[-1]["code"] == "not_lease_holder"
    second.send(op="acquire_control", id=8)
    await second.sees_id(8)
    await fleet.stopped()
    push(first, id=9)
    await first.sees_id(9)
    fleet.relay.router.leave(second.session)
    await eventually(lambda: watching.of("control")[-1]["holder"] is None)


async def test_a_stop_of_a_client_that_does_not_drive_stops_the_robot(fleet: Fleet):
    driver_ = await fleet.driven()
    other = fleet.relay.client()
    other.send(op="stop", id=1)
    await other.sees_id(1)
    assert other.of("stop")[0]["topics"] == ["/cmd_vel"]
    await fleet.stopped()
    push(driver_, id=2)
    await driver_.sees_id(2)
    assert driver_.of("status")[-1]["code"] == "tripped"


@pytest.mark.parametrize("topic", ["/base/cmd_vel", "a b", "/" + "x" * 250])
async def test_a_stop_for_a_topic_that_nobody_knows_stops_the_robot(fleet: Fleet, topic: str):
    await fleet.driven()
    other = fleet.relay.client()
    other.send(op="stop", topic=topic, id=1)
    await other.sees_id(1)
    assert other.of("stop")[0]["topics"] == ["/cmd_vel"]
    await fleet.stopped()


async def test_a_refusal_by_the_robot_is_passed_on_and_leaves_the_states_as_they_are(fleet: Fleet):
    refusal = ToldEvent(what="refusal", number=0, code="forbidden", text="no")
    told = Told(epoch=1, time_ns=1, events=(refusal,))
    commands = fleet.link.commands
    await eventually(lambda: commands._states.of("/cmd_vel") is not None)
    fleet.link.ask = lambda operation, on_told: on_told(told)  # type: ignore[method-assign]
    client = fleet.relay.client()
    client.send(op="stop", id=1)
    assert [frame["code"] for frame in client.of("status")] == ["forbidden"]
    client.send(op="acquire_control", id=2)
    assert commands._states.of("/cmd_vel") is not None


async def test_a_relay_asks_for_the_topics_until_the_robot_answers(
    fleet: Fleet, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(relay_driving, "STATE_S", 0.01)
    asked: list[OnTold] = []
    fleet.link.ask = lambda operation, on_told: asked.append(on_told)  # type: ignore[method-assign]
    fleet.link.commands._on_look(None)
    await eventually(lambda: len(asked) == 1)
    asked[0](None)
    await eventually(lambda: len(asked) == 2)


async def test_commands_that_a_link_held_back_move_nothing(fleet: Fleet):
    client = await fleet.driven()
    fleet.link.is_cut = True
    before = len(fleet.link.held)
    for _ in range(5):
        push(client)  # the last beat is still young
    assert len(fleet.link.held) == before + 5
    await fleet.stopped()
    await asyncio.sleep(BEAT_S)
    push(client, id=3)
    await client.sees_id(3)
    assert client.of("status")[-1]["code"] == "stale_command"
    count = len(fleet.heard)
    fleet.link.come_back()
    push(client)
    await asyncio.sleep(0.3)
    assert len(fleet.heard) == count


async def test_a_client_whom_the_robot_has_lost_drives_on_after_a_zero(fleet: Fleet):
    client = await fleet.driven()
    fleet.link.robot.cut_off()
    await fleet.stopped()
    await asyncio.sleep(0.1)
    push(client, id=1)
    await client.sees_id(1)
    assert client.of("status")[-1]["code"] == "tripped"
    assert "does not know this client" in client.of("status")[-1]["msg"]

    async def drives_on() -> None:
        while speeds(fleet.heard)[-1] != 0.2:
            push(client, 0.0)
            await asyncio.sleep(0.4)
            push(client)
            await asyncio.sleep(0.1)

    await asyncio.wait_for(drives_on(), 30)


async def test_a_client_without_room_at_the_robot_hears_that_and_enters_later(fleet: Fleet):
    robot = fleet.link.robot
    for number in range(LIMITS.max_clients):
        robot.follow_token(f"client/b/{number}", is_there=True)
        enter = RemoteOperation(op="enter", client=f"b/{number}", number=1)
        robot.operate(enter.packed)
    client = fleet.relay.client()
    client.send(op="acquire_control", id=1)
    await client.sees_id(1)
    assert client.of("status")[-1]["code"] == "limit_exceeded"
    await eventually(lambda: "a1/1" not in robot._tokens)
    push(client, type=TWIST, id=2)
    await client.sees_id(2)
    assert "there was no room" in client.of("status")[-1]["msg"]
    push(client, 0.0, type=TWIST, id=3)
    await client.sees_id(3)
    assert client.of("status")[-1]["code"] == "limit_exceeded"
    robot.follow_token("client/b/7", is_there=False)
    client.send(op="acquire_control", id=4)
    await client.sees_id(4)
    assert client.of("acquire_control")[0]["holder"] == "you"


async def test_a_robot_that_does_not_answer_is_reported(fleet: Fleet, monkeypatch):
    fleet.link.ask = lambda operation, on_told: on_told(None)  # type: ignore[method-assign]
    client = fleet.relay.client()
    for operation in ({"op": "stop"}, {"op": "acquire_control"}):
        client.send(**operation, id=1)
        assert client.of("status")[-1]["code"] == "timeout"
    assert "emergency stop" in client.of("status")[0]["msg"]
    push(client, id=2)
    assert client.of("status")[-1]["code"] == "timeout"


async def test_a_state_that_does_not_come_is_reported_and_few_wait_for_it(
    fleet: Fleet, monkeypatch: pytest.MonkeyPatch
):
    await eventually(lambda: fleet.link.commands._states.of("/cmd_vel") is not None)
    fleet.link.is_cut = True
    fleet.link.commands._states._noted_s = None
    client = fleet.relay.client()
    monkeypatch.setattr(driving_states, "STATE_S", 0.05)
    for number in range(MAX_QUESTIONS):
        client.send(op="control", id=number)
    assert client.of("status") == []
    client.send(op="control", id="over")
    assert client.of("status")[-1]["id"] == "over"
    await eventually(lambda: len(client.of("status")) == MAX_QUESTIONS + 1)
    assert not fleet.link.is_listening


async def test_a_role_of_the_relay_that_may_not_publish_does_not_drive(fleet: Fleet):
    viewer = Identity("v", Policy(AccessConfig()).of("viewer"))
    client = fleet.relay.client(identity=viewer)
    client.send(op="acquire_control", id=1)
    push(client, id=2)
    assert [code for code, _ in client.statuses] == ["forbidden", "forbidden"]
    assert fleet.link.sent == []


async def test_a_relay_that_ends_stops_what_it_drives(fleet: Fleet):
    client = await fleet.driven()
    fleet.relay.router.stop_robots()
    await fleet.stopped()
    push(client, id=1)
    assert client.of("status")[-1]["code"] == "tripped"


def test_the_requests_of_commands_are_remembered_to_a_limit():
    session = SimpleNamespace()
    known = driver.RemoteDriver("a/1", session)  # type: ignore[arg-type]

    for number in range(MAX_ASKED + 1):
        known.remember(number, Publish(id=str(number), topic="/t", msg={}))
    assert len(known._asked) == MAX_ASKED
    assert 0 not in known._asked


async def test_a_robot_that_sends_anything_does_no_harm(fleet: Fleet):
    client = await fleet.driven()
    name = fleet.link.sent[0]
    events = (
        ToldEvent(what="answer", members={"op": "publish", "request_id": 1, "topic": 7}),
        ToldEvent(what="refusal", code="no_such_code", text="x"),
        ToldEvent(what="warning", number=2**62),
        ToldEvent(what="info"),
        ToldEvent(what="lost"),
    )
    topics = (TopicControl(topic="", members={}), TopicControl(topic="/x", members={"op": 3}))
    told = Told(epoch=name.epoch, time_ns=1, topics=topics, events=events)
    for who in ("", "a1/1", "b/9"):
        fleet.link.commands.hear(who, told)
    fleet.link.commands.hear_beat(Beat(0, 0))
    assert client.of("publish") == []
    assert client.of("status")[0]["code"] == "internal"
