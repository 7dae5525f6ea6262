# SPDX-License-Identifier: Apache-2.0
"""Clients of relays drive by the rules of the robot's own clients, and by those of their way."""

import json
import logging
import time
from collections.abc import AsyncIterator
from typing import Any

import pytest

from gateway.access.permissions import UNLIMITED, Identity, Policy
from gateway.config.access import AccessConfig
from gateway.core.commands.twist_values import TwistValues
from gateway.log_rate import BURST, LogRate
from gateway.sources.zenoh import driving_wire
from gateway.sources.zenoh.driving_wire import (
    RemoteCommand,
    RemoteOperation,
    RemoteStop,
    Told,
    ToldEvent,
    read_told,
)
from gateway.uplink.driving import (
    IDLE_NS,
    MAX_ECHO_NS,
    MAX_TOKENS,
    TOKEN_NS,
    UNKNOWN_PER_S,
    RemoteDrivers,
)
from gateway.uplink.driving_session import COMMANDS_PER_S, MAX_COMMANDS_AT_ONCE
from tests.client import eventually
from tests.core.commands.conftest import (  # noqa: F401  # fixtures
    TWIST,
    Build,
    Scene,
    build,
    push,
    scene,
    speeds,
)
from tests.core.conftest import LIMITS

CLIENT = "a1/1"
MS = 1_000_000


class Relay:
    """A relay that sends by hand, and notes what it is told."""

    def __init__(self, scene: Scene, identity: Identity = UNLIMITED) -> None:  # noqa: F811
        self.scene = scene
        self.heard = scene.listen()
        self.told: list[tuple[str, Told]] = []
        self.later_ns = 0  # the robot's clock, ahead of its drives'
        self.stands_ns: int | None = None
        self.drivers = RemoteDrivers(scene.router, identity, self._note, self._now_ns)
        self.numbers = 0

    def _now_ns(self) -> int:
        if self.stands_ns is not None:
            return self.stands_ns
        return time.monotonic_ns() + self.later_ns

    def _note(self, client: str, data: bytes) -> None:
        self.told.append((client, read_told(data)))

    def see(self, client: str = CLIENT, *, is_there: bool = True) -> None:
        self.drivers.follow_token(f"client/{client}", is_there=is_there)

    def operate(self, op: str, client: str = CLIENT, **more: Any) -> Told:
        self.numbers += 1
        more = {"topic": "/cmd_vel", **more}
        operation = RemoteOperation(op=op, client=client, number=self.numbers, **more)  # type: ignore[arg-type]
        return read_told(self.drivers.operate(operation.packed))

    def enter(self, client: str = CLIENT) -> None:
        self.see(client)
        assert self.operate("enter", client).events == ()

    def command(self, x: float = 0.2, client: str = CLIENT, **more: Any) -> list[ToldEvent]:
        """Send a command, and return what its client is told about it at once."""
        self.numbers += 1
        beat = self.drivers.beat
        known: dict[str, Any] = {
            "epoch": beat.epoch,
            "number": self.numbers,
            "beat_ns": beat.time_ns,
            "topic": "/cmd_vel",
            "type": TWIST,
            "values": (x, 0.0, 0.0, 0.0, 0.0, 0.0),
            "wants_answer": True,
        }
        before = len(self.told)
        self.drivers.command(f"cmd/{client}", RemoteCommand(**(known | more)).packed)
        return [event for name, told in self.told[before:] if name for event in told.events]

    def stop(self, data: bytes | None = None, **more: Any) -> Told:
        data = RemoteStop(**more).packed if data is None else data
        return read_told(self.drivers.stop(data))

    async def driven(self) -> None:
        self.enter()
        self.command()
        await eventually(lambda: speeds(self.heard) == [0.2])

    async def stopped(self) -> None:
        await eventually(lambda: speeds(self.heard)[-5:] == [0.0] * 5)


@pytest.fixture
async def relay(scene: Scene) -> AsyncIterator[Relay]:  # noqa: F811
    relay = Relay(scene)
    yield relay
    relay.drivers.close()


def codes(events: list[ToldEvent]) -> list[str]:
    return [event.code or event.what for event in events]


def control_of(told: Told) -> dict[str, Any]:
    [topic] = told.topics
    return {**topic.members, "holder": topic.holder, "type": topic.type}


async def test_a_remote_client_drives_and_its_lost_token_stops_the_robot(relay: Relay):
    await relay.driven()
    assert control_of(relay.operate("look"))["holder"] == CLIENT
    assert control_of(relay.operate("look"))["type"] == TWIST
    relay.see(is_there=False)
    await relay.stopped()
    assert control_of(relay.operate("look"))["cause"] == "disconnect"
    assert codes(relay.command()) == ["lost"]


async def test_silence_stops_the_robot_by_the_command_timeout(relay: Relay):
    await relay.driven()
    await relay.stopped()
    state = control_of(relay.operate("look"))
    assert (state["cause"], state["state"]) == ("deadline", "stopped")


@pytest.mark.parametrize("age_ms", [-1, MAX_ECHO_NS // MS + 1])
async def test_a_command_whose_beat_is_old_or_from_the_future_moves_nothing(
    relay: Relay, age_ms: int
):
    relay.enter()
    time_ns = relay.drivers.beat.time_ns - age_ms * MS
    if age_ms < 0:
        time_ns += 10**9
    assert codes(relay.command(beat_ns=time_ns)) == ["stale_command"]
    relay.command(number=relay.numbers + 1, beat_ns=relay.drivers.beat.time_ns - 250 * MS)
    await eventually(lambda: speeds(relay.heard) == [0.2])


async def test_a_late_zero_stops_the_robot_all_the_same(relay: Relay):
    await relay.driven()
    old_ns = relay.drivers.beat.time_ns - 10 * MAX_ECHO_NS
    assert codes(relay.command(0.0, beat_ns=old_ns)) == ["stale_command"]
    await relay.stopped()
    assert control_of(relay.operate("look"))["cause"] == "zero"


async def test_a_command_of_another_epoch_or_out_of_order_moves_nothing(relay: Relay):
    relay.enter()
    assert codes(relay.command(epoch=1)) == ["stale_command"]
    assert codes(relay.command(number=1)) == ["stale_command"]
    relay.operate("acquire")
    assert codes(relay.command(number=relay.numbers - 1)) == ["stale_command"]
    relay.command()
    await eventually(lambda: speeds(relay.heard) == [0.2])


async def test_a_loss_of_the_router_stops_the_robot_and_voids_all_commands_from_before(
    relay: Relay,
):
    await relay.driven()
    epoch = relay.drivers.beat.epoch
    relay.drivers.cut_off()
    await relay.stopped()
    assert codes(relay.command(epoch=epoch)) == ["lost"]
    relay.enter()
    assert codes(relay.command(epoch=epoch)) == ["stale_command"]
    assert relay.scene.router.counts()["clients"] == 2  # the observer of states, and this one


async def test_a_stop_works_for_anybody_however_old_long_or_malformed_it_is(relay: Relay):
    unknown = RemoteStop(topic="/no").packed
    for data in (b"", b"{", b"\xff" * 9999, b'{"topic":7}', RemoteStop().packed, unknown):
        relay.enter()
        relay.command(0.0)
        await eventually(lambda: control_of(relay.operate("look"))["tripped"] is False)
        relay.command()
        await eventually(lambda: bool(speeds(relay.heard)) and speeds(relay.heard)[-1] == 0.2)
        [event] = relay.stop(data).events
        assert event.members == {"topics": ["/cmd_vel"]}
        await relay.stopped()
        assert control_of(relay.operate("look"))["cause"] == "stop"
        relay.see(is_there=False)
    assert relay.drivers.clients == 0


async def test_a_stop_voids_the_commands_before_it_that_come_after_it(relay: Relay):
    await relay.driven()
    relay.stop(client=CLIENT, number=relay.numbers + 3)
    await relay.stopped()
    assert codes(relay.command()) == ["stale_command"]


async def test_a_stop_needs_no_room(relay: Relay):
    for number in range(LIMITS.max_clients):
        relay.enter(f"b/{number}")
    told = relay.operate("acquire", "c/1")
    assert codes(list(told.events)) == ["limit_exceeded", "lost"]
    assert "limits.max_clients" in told.events[0].text
    assert codes(list(relay.stop(client="c/1").events)) == ["answer"]


async def test_the_client_that_is_idle_the_longest_and_has_no_control_makes_room(relay: Relay):
    for number in range(LIMITS.max_clients):
        relay.enter(f"b/{number}")
    relay.operate("acquire", "b/0")
    relay.later_ns = IDLE_NS + 1
    relay.operate("enter", "b/1")
    relay.enter("c/1")
    assert relay.told[-1][0] == "b/2"
    assert codes(list(relay.told[-1][1].events)) == ["lost"]
    assert relay.drivers.clients == LIMITS.max_clients


async def test_an_acquire_that_a_stop_has_overtaken_gets_no_control(relay: Relay):
    relay.enter()
    relay.stop(client=CLIENT, number=relay.numbers + 3)
    told = relay.operate("acquire")
    assert codes(list(told.events)) == ["stale_command"]
    assert control_of(told)["holder"] is None


async def test_two_clients_of_relays_and_one_of_the_robot_share_one_lease(relay: Relay):
    await relay.driven()
    relay.enter("a1/2")
    assert codes(relay.command(client="a1/2")) == ["not_lease_holder"]
    own = relay.scene.client()
    push(own)
    assert own.of("status")[-1]["code"] == "not_lease_holder"
    [event] = relay.operate("acquire", "a1/2").events
    assert (event.what, event.members["holder"]) == ("answer", "you")
    await relay.stopped()
    assert control_of(relay.operate("look"))["holder"] == "a1/2"
    [event] = relay.operate("release", "a1/2").events
    assert event.members["holder"] is None


async def test_an_invalid_message_stops_the_robot_and_is_answered_by_the_relay(relay: Relay):
    await relay.driven()
    assert relay.command(values=None, wants_answer=False) == []
    await relay.stopped()
    assert control_of(relay.operate("look"))["cause"] == "invalid_value"


async def test_advertising_opens_and_withdrawing_stops(relay: Relay):
    relay.see()
    told = relay.operate("advertise", type="std_msgs/String")
    assert codes(list(told.events)) == ["type_conflict"]
    told = relay.operate("advertise", type=TWIST)
    assert [event.what for event in told.events] == ["info"]
    relay.command()
    await eventually(lambda: speeds(relay.heard) == [0.2])
    relay.operate("unadvertise")
    await relay.stopped()


async def test_only_command_topics_are_reached(relay: Relay):
    relay.enter()
    assert codes(relay.command(topic="/rosout")) == ["not_found"]
    assert relay.scene.router.counts()["publishers"] == 0


async def test_a_role_that_may_not_publish_does_not_drive(scene: Scene):  # noqa: F811
    viewer = Identity("uplink", Policy(AccessConfig()).of("viewer"))
    relay = Relay(scene, viewer)
    relay.enter()
    assert codes(relay.command()) == ["forbidden"]
    assert codes(list(relay.operate("acquire").events)) == ["forbidden"]
    assert codes(list(relay.stop().events)) == ["answer"]
    relay.drivers.close()


async def test_a_client_whose_token_does_not_come_leaves(relay: Relay):
    relay.operate("acquire")
    relay.drivers.tick()
    assert relay.drivers.clients == 1
    relay.later_ns = TOKEN_NS + 1
    relay.drivers.tick()
    assert relay.drivers.clients == 0
    for number in range(MAX_TOKENS + 1):
        relay.see(f"d/{number}")
    assert relay.drivers.counts.tokens_refused == 1
    relay.operate("enter", f"d/{MAX_TOKENS - 1}")
    relay.operate("enter", f"d/{MAX_TOKENS}")  # whose token is one too many
    relay.operate("enter", "e/1")
    relay.see("e/1")  # of a client that has entered, none is too many
    relay.later_ns = 3 * TOKEN_NS
    relay.drivers.tick()
    assert relay.drivers.clients == 2


async def test_a_token_that_goes_ends_its_client_although_there_is_no_room_for_more(relay: Relay):
    heard = relay.heard
    for number in range(MAX_TOKENS):
        relay.see(f"d/{number}")
    relay.operate("enter")
    relay.see()
    relay.command()
    await eventually(lambda: speeds(heard) == [0.2])
    relay.see(is_there=False)
    assert relay.drivers.clients == 0
    await relay.stopped()
    relay.see("d/0", is_there=False)  # makes room
    relay.enter()
    relay.later_ns = 2 * TOKEN_NS
    relay.drivers.tick()
    assert relay.drivers.clients == 1


async def test_a_flood_of_malformed_messages_writes_few_lines_of_each_kind(relay: Relay, caplog):
    caplog.handler.addFilter(limit := LogRate())
    try:
        with caplog.at_level(logging.WARNING):
            for number in range(1000):
                relay.drivers.follow_token(f"client/x{number}", is_there=True)
                relay.drivers.operate(b"x" * number)
    finally:
        caplog.handler.removeFilter(limit)
    assert relay.drivers.counts.malformed == 2000
    assert len(caplog.records) == BURST


async def test_a_flood_of_commands_is_dropped_unread(relay: Relay):
    relay.enter()
    relay.stands_ns = time.monotonic_ns()
    for _ in range(MAX_COMMANDS_AT_ONCE + 9):
        relay.drivers.command(f"cmd/{CLIENT}", b"")
    assert relay.drivers.counts.malformed == MAX_COMMANDS_AT_ONCE


async def test_commands_of_clients_that_are_not_known_are_answered_at_a_limited_rate(relay: Relay):
    for number in range(1000):
        relay.command(client=f"e/{number}")
    assert 0 < len(relay.told) < 100


async def test_malformed_messages_are_counted_and_reported(relay: Relay, caplog):
    relay.enter()
    with caplog.at_level(logging.WARNING):
        for data in (b"", b"[]", b"{" * 4000, b'{"epoch":-1}'):
            relay.drivers.command(f"cmd/{CLIENT}", data)
            assert codes(list(read_told(relay.drivers.operate(data)).events)) == ["bad_request"]
    for field in ("waited_ms", "monotonic_ms"):  # in ns it would be no number any more
        command = {"epoch": 1, "number": 1, "beat_ns": 1, "topic": "/cmd_vel", "type": TWIST}
        data = json.dumps({**command, field: 1e308}).encode()
        relay.drivers.command(f"cmd/{CLIENT}", data)
    relay.drivers.command("cmd/../..", b"")
    relay.drivers.follow_token("client/x", is_there=True)
    assert relay.drivers.counts.malformed == 12
    assert "a message that no relay sends is left out: command" in caplog.text


def test_values_that_a_relay_has_read_are_not_read_again():
    from gateway.core.commands.twist_values import read
    from gateway.drive.velocity import Velocity

    values = TwistValues(Velocity(0.5), "base")
    assert read(None, values) is values  # type: ignore[arg-type]


def test_the_limits_are_those_of_the_reference():
    """Their sum is docs/reference/driving-wire.md: relays of others rely on it."""
    assert (MAX_ECHO_NS, TOKEN_NS, MAX_TOKENS) == (300 * MS, 1000 * MS, 1024)
    assert IDLE_NS == 10_000 * MS
    assert (COMMANDS_PER_S, MAX_COMMANDS_AT_ONCE, UNKNOWN_PER_S) == (250, 50, 20)
    wire = driving_wire
    assert (wire.MAX_COMMAND_BYTES, wire.MAX_OPERATION_BYTES) == (2048, 4096)
    assert (wire.MAX_ANSWER_BYTES, wire.MAX_EVENTS) == (65536, 32)
    assert (wire.MAX_NAME_CHARACTERS, wire.MAX_TEXT_CHARACTERS) == (256, 2048)
