# SPDX-License-Identifier: Apache-2.0
"""Driving over a real Zenoh router, by a relay that is written by hand."""

import asyncio
import contextlib
import threading
from collections.abc import AsyncIterator, Iterator
from typing import Any

import pytest

pytest.importorskip("zenoh")
import zenoh

from gateway.access.permissions import UNLIMITED
from gateway.sources.zenoh.driving_wire import (
    MAX_COMMAND_BYTES,
    MAX_OPERATION_BYTES,
    Beat,
    RemoteCommand,
    RemoteOperation,
    RemoteStop,
    Told,
    read_beat,
    read_told,
)
from gateway.uplink import driving_edge
from gateway.uplink.driving_edge import MAX_WAITING, DrivingEdge
from tests.client import eventually
from tests.core.commands.conftest import TWIST, Scene, build, scene, speeds  # noqa: F401
from tests.sources.zenoh.outside import Router, client

CLIENT = "a1/1"


class HandMadeRelay:
    """The least that a relay must do."""

    def __init__(self, address: str) -> None:
        self.session = client(address)
        self.beats: list[Beat] = []
        self.told: list[tuple[str, Told]] = []
        self.numbers = 0
        self.kept = [
            self.session.declare_subscriber(
                "beat", lambda sample: self.beats.append(read_beat(sample.payload.to_bytes()))
            ),
            self.session.declare_subscriber("control/**", self._hear),
        ]

    def _hear(self, sample: Any) -> None:
        self.told.append((str(sample.key_expr), read_told(sample.payload.to_bytes())))

    def show(self, name: str = CLIENT) -> Any:
        self.kept.append(self.session.liveliness().declare_token(f"client/{name}"))
        return self.kept[-1]

    def ask(self, key: str, payload: bytes) -> list[Told]:
        replies = self.session.get(key, payload=payload, timeout=10)
        return [read_told(each.ok.payload.to_bytes()) for each in replies if each.ok is not None]

    def operate(self, op: str, name: str = CLIENT) -> Told:
        self.numbers += 1
        operation = RemoteOperation(op=op, client=name, number=self.numbers, topic="/cmd_vel")  # type: ignore[arg-type]
        [told] = self.ask("lease", operation.packed)
        return told

    def command(self, x: float = 0.2) -> None:
        self.numbers += 1
        beat = self.beats[-1]
        command = RemoteCommand(
            epoch=beat.epoch,
            number=self.numbers,
            beat_ns=beat.time_ns,
            topic="/cmd_vel",
            type=TWIST,
            values=(x, 0.0, 0.0, 0.0, 0.0, 0.0),
            wants_answer=True,
        )
        self.session.put(f"cmd/{CLIENT}", command.packed)


@pytest.fixture
def router() -> Iterator[Router]:
    with contextlib.closing(Router()) as router:
        yield router


@pytest.fixture
async def edge(router: Router, scene: Scene) -> AsyncIterator[DrivingEdge]:  # noqa: F811
    session = client(router.address)
    edge = DrivingEdge(scene.router, UNLIMITED, session)
    yield edge
    edge.close()
    session.close()


@pytest.fixture
def relay(router: Router, edge: DrivingEdge) -> Iterator[HandMadeRelay]:
    relay = HandMadeRelay(router.address)
    yield relay
    relay.session.close()


async def in_thread(call: Any, *arguments: Any) -> Any:
    """Make a call that waits for the loop."""
    return await asyncio.to_thread(call, *arguments)


async def enter(relay: HandMadeRelay, edge: DrivingEdge) -> Any:
    token = relay.show()
    await in_thread(relay.operate, "acquire")
    await eventually(lambda: bool(relay.beats))
    return token


async def until_it_moves(relay: HandMadeRelay, heard: list[Any]) -> None:
    """Send single commands: on a machine that pauses, one may be too late."""
    for _ in range(30):
        if speeds(heard)[-1:] == [0.2]:
            return
        relay.command()
        with contextlib.suppress(TimeoutError):
            await eventually(lambda: speeds(heard)[-1:] == [0.2], within_s=1)
    raise AssertionError(relay.told[-1])


async def test_a_relay_drives_and_hears_who_does(
    relay: HandMadeRelay,
    edge: DrivingEdge,
    scene: Scene,  # noqa: F811
):
    heard = scene.listen()
    token = await enter(relay, edge)
    await until_it_moves(relay, heard)
    await eventually(
        lambda: any(
            key == "control" and told.topics and told.topics[0].holder == CLIENT
            for key, told in relay.told
        )
    )
    token.undeclare()
    await eventually(lambda: speeds(heard)[-5:] == [0.0] * 5)
    await eventually(lambda: edge.drivers.clients == 0)
    relay.command()
    await eventually(lambda: relay.told[-1][0] == f"control/{CLIENT}")
    assert relay.told[-1][1].events[0].what == "lost"


async def test_the_end_of_the_router_ends_all_clients(
    relay: HandMadeRelay,
    edge: DrivingEdge,
    scene: Scene,  # noqa: F811
    router: Router,
):
    heard = scene.listen()
    await enter(relay, edge)
    await until_it_moves(relay, heard)
    epoch = edge.drivers.beat.epoch
    threading.Thread(target=router.close, daemon=True).start()
    await eventually(lambda: edge.drivers.clients == 0)
    await eventually(lambda: speeds(heard)[-5:] == [0.0] * 5)
    assert edge.drivers.beat.epoch != epoch


class Query:
    payload = None

    def reply(self, *arguments: Any, **options: Any) -> None: ...

    def drop(self) -> None: ...


async def test_a_stop_that_waits_is_carried_out_before_the_end(edge: DrivingEdge):
    done: list[str] = []
    stop, close = edge.drivers.stop, edge.drivers.close
    edge.drivers.stop = lambda data: done.append("stop") or stop(data)  # type: ignore[method-assign,func-returns-value]
    edge.drivers.close = lambda: done.append("close") or close()  # type: ignore[method-assign,func-returns-value]
    edge._on_stop(Query())
    edge.close()
    assert done == ["stop", "close"]


async def test_an_edge_that_zenoh_refuses_leaves_nothing_behind(scene: Scene):  # noqa: F811
    class Session:
        def declare_publisher(self, *arguments: Any, **options: Any) -> None: ...

        def declare_queryable(self, *arguments: Any) -> None:
            raise zenoh.ZError("closed")

    before = scene.router.counts()["clients"]
    with pytest.raises(zenoh.ZError):
        DrivingEdge(scene.router, UNLIMITED, Session())
    assert scene.router.counts()["clients"] == before


async def test_a_beat_goes_out_before_the_work_of_its_time(edge: DrivingEdge):
    await eventually(lambda: bool(edge._session.info.routers_zid()))
    done: list[str] = []
    edge.drivers.tick = lambda: done.append("tick")  # type: ignore[method-assign]
    edge._put = lambda put, data: done.append("beat")  # type: ignore[method-assign]
    edge._timer.cancel()
    edge._on_time()
    assert done[:2] == ["beat", "tick"]


async def test_a_stop_is_carried_out_however_long_it_is_and_however_many_wait(
    relay: HandMadeRelay,
    edge: DrivingEdge,
    scene: Scene,  # noqa: F811
):
    scene.listen()
    await enter(relay, edge)
    for data in (b"x" * 10 * MAX_OPERATION_BYTES, RemoteStop().packed):
        [told] = await in_thread(relay.ask, "lease/stop", data)
        assert told.events[0].members == {"topics": ["/cmd_vel"]}
    before = scene.audited.count({"event": "stop_requested"})
    for _ in range(MAX_WAITING + 1):
        edge._on_stop(Query())
    stops: list[bytes] = []
    edge.drivers.stop = lambda data: stops.append(data) or b""  # type: ignore[method-assign,func-returns-value]
    edge._take()
    assert before == 0
    assert len(stops) == MAX_WAITING + 1


async def test_waiting_messages_are_bounded_and_counted(edge: DrivingEdge, scene: Scene):  # noqa: F811
    class Arrived:
        key_expr = f"cmd/{CLIENT}"
        kind = zenoh.SampleKind.PUT
        dropped = 0

        def __init__(self, size: int = 1) -> None:
            self.payload = zenoh.ZBytes(b"x" * size)

        def drop(self) -> None:
            Arrived.dropped += 1

    edge._on_command(Arrived(MAX_COMMAND_BYTES + 1))
    assert (edge.drivers.counts.dropped, len(edge._commands)) == (1, 0)
    for _ in range(MAX_WAITING + 1):
        edge._on_command(Arrived())
        edge._on_operation(Arrived())
    assert edge.drivers.counts.dropped == 3
    assert (len(edge._commands), len(edge._operations)) == (MAX_WAITING, MAX_WAITING)
    assert Arrived.dropped == 1
    edge._operations.clear()


async def test_tokens_beyond_the_limit_end_all_clients_for_one_may_have_gone(
    relay: HandMadeRelay,
    edge: DrivingEdge,
    scene: Scene,  # noqa: F811
):
    heard = scene.listen()
    await enter(relay, edge)
    await until_it_moves(relay, heard)
    epoch = edge.drivers.beat.epoch

    class Token:
        kind = zenoh.SampleKind.PUT

        def __init__(self, number: int) -> None:
            self.key_expr = f"client/b/{number}"

    for number in range(driving_edge.MAX_WAITING_TOKENS + 1):
        edge._on_token(Token(number))
    await eventually(lambda: speeds(heard)[-5:] == [0.0] * 5)
    assert edge.drivers.clients == 0
    assert edge.drivers.beat.epoch != epoch
    await enter(relay, edge)
    await until_it_moves(relay, heard)


def test_the_numbers_of_the_edge_are_those_of_the_reference():
    assert (driving_edge.BEAT_S, driving_edge.STATES_S) == (0.05, 1.0)
    assert (MAX_WAITING, driving_edge.MAX_WAITING_TOKENS) == (256, 4096)
