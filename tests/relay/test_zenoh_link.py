# SPDX-License-Identifier: Apache-2.0
"""A relay's link to a robot over a real Zenoh router, with the robot's end as it is."""

import contextlib
from collections.abc import AsyncIterator
from functools import partial
from typing import Any

import pytest

pytest.importorskip("zenoh")
import zenoh

from gateway.access.permissions import UNLIMITED
from gateway.log_rate import BURST, LogRate
from gateway.relay import command_sender, driver, driving_states, zenoh_link
from gateway.relay.driving import RemoteCommands
from gateway.relay.zenoh_link import MAX_ASKED, MAX_WAITING, ZenohRobotLink
from gateway.sources.zenoh.driving_wire import RemoteOperation, RemoteStop, Told
from gateway.uplink.driving_edge import DrivingEdge
from tests.client import eventually
from tests.core.commands.conftest import Scene, build, push, scene, speeds  # noqa: F401
from tests.core.conftest import Bench
from tests.relay.test_driving import open_relay_core
from tests.sources.zenoh.outside import Router, client


class Line:
    """A robot's core, a relay's core, and Zenoh between them."""

    def __init__(self, robot: Scene, edge: DrivingEdge, relay: Bench, link: ZenohRobotLink):
        self.robot, self.edge, self.relay, self.link = robot, edge, relay, link
        self.heard = robot.listen()


@pytest.fixture
async def line(scene: Scene) -> AsyncIterator[Line]:  # noqa: F811
    with contextlib.ExitStack() as stack:
        router = stack.enter_context(contextlib.closing(Router()))
        near, far = (stack.enter_context(contextlib.closing(client(router.address))) for _ in "12")
        edge = stack.enter_context(contextlib.closing(DrivingEdge(scene.router, UNLIMITED, near)))
        links: list[ZenohRobotLink] = []

        def open_link(commands: RemoteCommands) -> ZenohRobotLink:
            links.append(ZenohRobotLink(far, commands))
            return links[0]

        bench = stack.enter_context(open_relay_core(partial(RemoteCommands, (), open_link)))
        yield Line(scene, edge, bench, links[0])


async def test_a_client_drives_over_zenoh_until_it_leaves(line: Line):
    viewer = line.relay.client()
    assert "/cmd_vel" not in line.relay.router.commands
    viewer.send(op="stop", topic="/cmd_vel", id=1)
    await viewer.sees_id(1)
    assert viewer.of("stop")[0]["topics"] == ["/cmd_vel"]
    await eventually(lambda: "/cmd_vel" in line.relay.router.commands)  # by the relay's question
    viewer.send(op="acquire_control", id=3)
    await viewer.sees_id(3)
    assert viewer.of("acquire_control")[0]["holder"] == "you"
    for _ in range(30):  # on a machine that pauses, one may be too late
        if speeds(line.heard)[-1:] == [0.2]:
            break
        push(viewer)
        with contextlib.suppress(TimeoutError):
            await eventually(lambda: speeds(line.heard)[-1:] == [0.2], within_s=1)
    assert 0.2 in speeds(line.heard)
    line.relay.router.leave(viewer.session)
    await eventually(lambda: speeds(line.heard)[-5:] == [0.0] * 5)
    await eventually(lambda: line.edge.drivers.clients == 0)


async def test_a_robot_that_is_not_there_is_reported_at_once(line: Line):
    line.edge.close()
    told: list[Told | None] = []
    line.link.ask(RemoteStop(), told.append)
    await eventually(lambda: told == [None])
    line.edge._declared.clear()


async def test_operations_under_way_and_messages_of_a_robot_are_limited(
    line: Line, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
):
    told: list[Any] = []
    await eventually(lambda: line.link._asked == 0)
    monkeypatch.setattr(line.link, "_session", SilentSession())
    look = RemoteOperation(op="look", client="a/1", number=1)
    for _ in range(MAX_ASKED + 1):
        line.link.ask(look, told.append)
    assert told == [None]
    line.link.ask(RemoteStop(), told.append)  # never refused
    assert told == [None]

    class Sample:
        key_expr = "control"
        payload = zenoh.ZBytes(b"")

    for _ in range(MAX_WAITING + 1):
        line.link._on_told(Sample())
    assert len(line.link._told) == MAX_WAITING
    caplog.handler.addFilter(limit := LogRate())
    line.link._take()
    caplog.handler.removeFilter(limit)
    assert line.link._commands.relayed.malformed == MAX_WAITING
    assert caplog.text.count("a message that no robot sends is left out") == BURST


async def test_a_token_that_zenoh_does_not_withdraw_keeps_no_other(line: Line):
    hidden: list[str] = []

    class Token:
        def undeclare(self) -> None:
            hidden.append("x")
            raise zenoh.ZError("closed")

    line.link._tokens.update({"a/1": Token(), "a/2": Token()})
    line.link.close()
    assert len(hidden) == 2


async def test_a_session_that_has_ended_refuses_without_an_internal_error(
    line: Line, caplog: pytest.LogCaptureFixture
):
    viewer = line.relay.client()
    await eventually(lambda: line.link._asked == 0)
    line.link._session.close()
    viewer.send(op="acquire_control", topic="/cmd_vel", id=1)
    await viewer.sees_id(1)
    assert viewer.of("status")[-1]["code"] == "timeout"
    line.link.show("a/1")
    line.link.listen(is_on=False)
    line.link.listen(is_on=True)
    assert "a client was not shown to the robot" in caplog.text
    assert "Zenoh does not listen to the robot" in caplog.text


class SilentSession:
    """A session whose queries never end."""

    def get(self, *arguments: Any, **options: Any) -> None: ...


def test_the_numbers_of_a_relay_are_those_of_the_reference():
    assert (MAX_ASKED, MAX_WAITING, zenoh_link.ANSWER_S) == (1024, 1024, 2.0)
    assert (command_sender.BEAT_S, driver.MAX_ASKED) == (0.3, 256)
    assert (driving_states.STATE_S, driving_states.MAX_QUESTIONS) == (3.0, 4096)
