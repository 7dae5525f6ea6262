# SPDX-License-Identifier: Apache-2.0
"""One connection without a socket: its transport, its clock and its timers are ours."""

import asyncio
import errno
import itertools
import json
import random
import re
import socket
from collections.abc import AsyncIterator, Callable, Sequence
from typing import Any

import pytest
from websockets.frames import Opcode
from websockets.http11 import Request
from websockets.protocol import Event

from gateway.codec.types import Types
from gateway.fronts.rosbridge.session import RosbridgeSession
from gateway.sources.source import Sample
from gateway.transport import connection as connection_module
from gateway.transport import inbound as inbound_module
from gateway.transport import time_budget as time_budget_module
from gateway.transport import turns as turns_module
from gateway.transport import writing as writing_module
from gateway.transport.connection import Connection
from gateway.transport.connections import Connections
from gateway.transport.end import ConnectionEnd
from gateway.transport.frame_reader import FrameReader
from gateway.transport.front import ClientSession, Front, Fronts
from gateway.transport.inbound import READ_COST_S
from gateway.transport.server import Server
from schemas.installed import InstalledDefinitions
from tests.sources.fake import FakeRos
from tests.transport.conftest import Serve
from tests.transport.test_server import masked, upgrade
from tests.transport.timers import Timers

MIB = 1024**2
PONG = masked(Opcode.PONG, b"")
PING = masked(Opcode.PING, b"x" * 125)


SLICE_S = 0.004


class Transport(asyncio.Transport):
    """Keeps written data, forever or until it is `taken`."""

    def __init__(self) -> None:
        super().__init__()
        self.unsent = b""
        self.is_read = True
        self.is_aborted = False
        self.high_water_bytes: int | None = None
        self.options: dict[tuple[int, int], int] = {}
        self.tcp_state: int | None = None  # this is not TCP
        self.on_written: Callable[[], None] = lambda: None

    def get_extra_info(self, name: str, default: Any = None) -> Any:
        return {"peername": ("127.0.0.1", 1), "socket": self}.get(name, default)

    def setsockopt(self, level: int, option: int, value: int) -> None:
        self.options[level, option] = value

    def getsockopt(self, level: int, option: int, size: int) -> bytes:
        if size != 1 or self.tcp_state is None:
            raise OSError(errno.EOPNOTSUPP, "this is no TCP")
        return bytes([self.tcp_state])

    def set_write_buffer_limits(self, high: int | None = None, low: int | None = None) -> None:
        self.high_water_bytes = high

    def get_write_buffer_size(self) -> int:
        return len(self.unsent)

    def write_eof(self) -> None:
        pass  # the peer of these tests does not close

    def write(self, data: bytes | bytearray | memoryview) -> None:
        self.unsent += data
        self.on_written()

    def pause_reading(self) -> None:
        self.is_read = False

    def resume_reading(self) -> None:
        self.is_read = True

    def is_closing(self) -> bool:
        return self.is_aborted

    def abort(self) -> None:
        self.is_aborted = True

    def close(self) -> None:
        self.is_aborted = True


class ServerInterface:
    """The server that a connection comes to, which takes no note of it, and its front.

    Each operation takes *cost_s*.
    """

    def __init__(self, server: Server, pass_time: Callable[[float], None]) -> None:
        self._server = server
        self.connections = Connections(server.limits)
        self.connections.budgets = server.connections.budgets
        self._front = server.fronts.of(None)
        self.subprotocols = self._front.subprotocols
        self.fronts = Fronts(self)
        self._pass_time = pass_time
        self.cost_s = 0.0
        self.received: list[bytes] = []
        self.overtaken: list[bytes] = []  # of them
        self.leaving_cost_s = 0.0

    def __getattr__(self, name: str) -> Any:
        return getattr(self._server, name)

    def of(self, request: Request) -> "ServerInterface":
        return self

    def choose(self, offered: Sequence[str]) -> str | None:
        return self.fronts.choose(offered)

    def enter(self, connection: Connection, _: Front, request: Request) -> ClientSession | None:
        return self._server.enter(connection, self._front, request)

    def receive(self, session: RosbridgeSession, data: bytes) -> None:
        self._pass_time(self.cost_s)
        self.received.append(data)
        if session.turns.is_overtaken:
            self.overtaken.append(data)
        self._front.receive(session, data)

    def left(
        self, connection: Connection, session: RosbridgeSession | None, end: ConnectionEnd
    ) -> None:
        self._pass_time(self.leaving_cost_s)
        self._server.left(connection, session, end)


class Ready:
    """An entry whose turn has come."""

    size = 1
    is_being_encoded = False
    arrived_ns = 0

    def frame(self) -> bytes:
        return b"ready"


class Unencodable(Ready):
    """An entry that a bug keeps from being encoded."""

    def frame(self) -> bytes:
        raise ZeroDivisionError


class Wire(Timers):
    """A connection, its server and transport, and the time."""

    ros: FakeRos

    def __init__(
        self, server: Server, monkeypatch: pytest.MonkeyPatch, *, is_upgraded: bool = True
    ) -> None:
        super().__init__(monkeypatch, inbound_module, time_budget_module, turns_module)
        monkeypatch.setattr(connection_module, "time", inbound_module.time)
        monkeypatch.setattr(writing_module, "time", inbound_module.time)
        monkeypatch.setattr(inbound_module, "READ_COST_S", 0)
        self.transport = Transport()
        self.server = ServerInterface(server, self.take)
        self.connection = Connection(self.server)
        self.connection.connection_made(self.transport)
        if not is_upgraded:
            return
        self.receive(upgrade("Host: localhost"))
        assert b" 101 " in self.transport.unsent
        self.transport.unsent = b""

    def receive(self, data: bytes) -> None:
        assert self.transport.is_read
        buffer = self.connection.get_buffer(-1)
        buffer[: len(data)] = data
        self.connection.buffer_updated(len(data))
        for _ in [handle for handle in self.handles if handle.due_s <= self.now_s]:
            self.next_turn()

    @property
    def is_served(self) -> bool:
        """Return whether the next input is carried out at once."""
        inbound, turns = self.connection._inbound, self.connection.spending.turns
        return self.transport.is_read and not (inbound or inbound._is_waiting or turns._is_due)

    def until_served(self) -> float:
        """Do what is due until nothing of the client waits. Return how long that was to wait."""
        waited_s = 0.0
        while not self.is_served:
            waited_s += self.next_turn()
        return waited_s

    def pass_time(self, seconds: float, *, taken: int = 0, heard: bytes = b"") -> None:
        """Let time pass, in which the peer takes some bytes and sends some."""
        self.now_s += seconds
        self.transport.unsent = self.transport.unsent[taken:]
        if heard:
            self.receive(heard)
        self.connection.tick(self.now_s)

    @property
    def carried_out(self) -> list[int | str]:
        """The operations that were carried out, pings by their ids, in their order."""
        return [
            int(found[1]) if (found := re.match(rb'{"op":"ping","id":(\d+)', data)) else "other"
            for data in self.server.received
        ]

    @property
    def pongs(self) -> list[int]:
        """The ids of the ping operations that were carried out, in their order."""
        return [
            int(found) for found in re.findall(rb'"op":"pong","id":(\d+)', self.transport.unsent)
        ]


def pings(*ids: int) -> bytes:
    return b"".join(masked(Opcode.TEXT, b'{"op":"ping","id":%d}' % id_) for id_ in ids)


@pytest.fixture
async def wire(serve: Serve, monkeypatch: pytest.MonkeyPatch) -> AsyncIterator[Wire]:
    async with serve() as served:
        wire = Wire(served.server, monkeypatch)
        wire.ros = served.ros
        yield wire
        wire.connection.connection_lost(None)


def test_so_much_is_read_at_a_time_that_others_get_their_turn(wire: Wire):
    assert len(wire.connection.get_buffer(-1)) == 16 * 1024


def test_so_much_waits_in_the_transport_and_the_rest_where_it_can_be_dropped(wire: Wire):
    assert wire.transport.high_water_bytes == 64 * 1024


def test_little_waits_in_the_kernel_which_finds_a_dead_link_within_12_s(wire: Wire):
    assert wire.transport.options == {
        (socket.IPPROTO_TCP, socket.TCP_NOTSENT_LOWAT): 16 * 1024,
        (socket.SOL_SOCKET, socket.SO_KEEPALIVE): 1,
        (socket.IPPROTO_TCP, socket.TCP_KEEPIDLE): 6,
        (socket.IPPROTO_TCP, socket.TCP_KEEPINTVL): 2,
        (socket.IPPROTO_TCP, socket.TCP_KEEPCNT): 3,
    }


@pytest.mark.parametrize("closed_by", ["peer", "gateway"])
def test_nothing_goes_behind_a_close_frame(wire: Wire, closed_by: str):
    outbox = wire.connection.session.outbox
    queue = outbox.open_queue(1, None)
    queue.put(Ready())
    assert wire.transport.unsent == b"ready"
    assert outbox.socket is not None
    if closed_by == "peer":
        wire.receive(masked(Opcode.CLOSE, (1000).to_bytes(2, "big")))
    else:
        wire.connection.close(1000, "enough")
    assert wire.connection.session is not None
    until_closed = wire.transport.unsent
    assert len(until_closed) > len(b"ready")
    queue.put(Ready())
    wire.connection.flush()
    assert wire.transport.unsent == until_closed
    assert outbox.socket is None


@pytest.mark.parametrize("seed", range(20))
def test_samples_come_in_their_order_whatever_way_they_go(wire: Wire, seed: int):
    chance = random.Random(seed)
    subscribe = b'{"op":"subscribe","topic":"/chatter","type":"std_msgs/String","queue_length":100}'
    wire.receive(masked(Opcode.TEXT, subscribe))
    (subscription,) = wire.ros.subscriptions
    encode = Types(InstalledDefinitions()).get("std_msgs/msg/String").encode
    numbers = iter(range(60))
    is_full = False

    def fill() -> None:  # as asyncio does, within the write that fills the socket
        nonlocal is_full
        if not is_full and chance.random() < 0.3:
            is_full = True
            wire.connection.pause_writing()

    def take() -> None:
        nonlocal is_full
        if is_full:
            is_full = False
            wire.connection.resume_writing()

    wire.transport.on_written = fill
    while batch := list(itertools.islice(numbers, chance.choice([1, 1, 1, 3]))):
        cdrs = [encode({"data": f"no {number}."}, now_ns=0) for number in batch]
        was_full, before = is_full, wire.transport.unsent
        subscription.on_samples([Sample(cdr, 0) for cdr in cdrs])
        assert not was_full or wire.transport.unsent == before
        if chance.random() < 0.3:
            take()
    wire.transport.on_written = lambda: None
    take()
    came = [int(found) for found in re.findall(rb"no (\d+)\.", wire.transport.unsent)]
    assert came == list(range(60))
    assert wire.connection.session.outbox.sent == 60


def test_a_message_of_10_mib_is_taken_and_a_larger_one_ends_the_connection(wire: Wire):
    largest = masked(Opcode.TEXT, b"x" * (10 * MIB))
    for start in range(0, len(largest), 16 * 1024):
        wire.receive(largest[start : start + 16 * 1024])
    wire.until_served()
    assert b"bad_json" in wire.transport.unsent
    assert wire.connection.session is not None
    wire.receive(masked(Opcode.TEXT, b"x" * (10 * MIB + 1))[: 16 * 1024])
    assert (1009).to_bytes(2, "big") in wire.transport.unsent


def test_a_too_large_message_ends_it_with_a_reason_even_if_waiting_messages_cannot_be_encoded(wire):
    session = wire.connection.session
    wire.connection.pause_writing()
    session.outbox.open_queue(1, None).put(Unencodable())
    wire.receive(masked(Opcode.TEXT, b"x" * (10 * MIB + 1))[: 16 * 1024])
    assert (1009).to_bytes(2, "big") in wire.transport.unsent


def test_long_work_goes_on_in_later_turns_and_in_order(wire: Wire):
    wire.server.cost_s = 0.001
    wire.receive(pings(*range(12)))
    assert wire.pongs == list(range(5))  # 4 ms, and one operation
    assert not wire.is_served
    assert wire.next_turn() == 0
    assert wire.pongs == list(range(10))
    wire.next_turn()
    assert wire.pongs == list(range(12))
    assert wire.is_served
    wire.run(0)  # the turns in which nothing is read
    assert not wire.handles


def padded_ping(size: int) -> bytes:
    return b'{"op":"ping","id":0%s}' % (b" " * (size - 20))


def in_pieces(message: bytes, count: int) -> bytes:
    size = -(-len(message) // count)
    pieces = [message[at : at + size].decode() for at in range(0, len(message), size)]
    members = {"op": "fragment", "id": "f", "total": count}
    return b"".join(
        masked(Opcode.TEXT, json.dumps({**members, "num": num, "data": data}).encode())
        for num, data in enumerate(pieces)
    )


@pytest.mark.parametrize("pieces", [None, 3])
def test_a_large_message_is_carried_out_in_the_turn_after_the_one_in_which_it_is_read(wire, pieces):
    message = padded_ping(8 * 1024 + 1)
    sent = in_pieces(message, pieces) if pieces else masked(Opcode.TEXT, message)
    wire.receive(sent + pings(1, 2))
    assert wire.pongs == []
    assert not wire.is_served
    assert wire.next_turn() == 0
    assert wire.pongs == [0, 1, 2]
    assert wire.is_served


def test_only_the_input_behind_a_large_message_waits_for_the_budget(wire):
    wire.server.cost_s = 0.3  # of reading, while the burst is 0.25 s
    wire.receive(masked(Opcode.TEXT, padded_ping(8 * 1024 + 1)) + pings(1, 2))
    assert wire.pongs == []
    assert wire.next_turn() == 0
    assert wire.pongs == [0]
    assert not wire.is_served
    assert wire.until_served() > 0
    assert wire.pongs == [0, 1, 2]


def test_a_message_of_8_kib_is_carried_out_at_once(wire: Wire):
    wire.receive(masked(Opcode.TEXT, padded_ping(8 * 1024)))
    assert wire.pongs == [0]


def test_the_work_of_a_large_message_ends_with_its_connection(wire: Wire):
    wire.receive(masked(Opcode.TEXT, padded_ping(8 * 1024 + 1)))
    wire.connection.close(1000, "")
    wire.until_served()
    assert wire.pongs == []


def test_no_more_than_4_kib_are_parsed_at_once(wire: Wire, monkeypatch: pytest.MonkeyPatch):
    sizes = []
    read = FrameReader.read

    def spy(reader: FrameReader, data: bytes) -> Sequence[Event]:
        sizes.append(len(data))
        wire.take(0.005)
        return read(reader, data)

    monkeypatch.setattr(FrameReader, "read", spy)
    wire.receive(PONG * 2048)
    assert sizes == [4096]
    wire.until_served()
    assert sizes == [4096] * 3
    sizes.clear()
    wire.receive(masked(Opcode.TEXT, bytes(100_000))[: 16 * 1024])  # of which nothing is whole
    assert sizes == [4096]
    wire.until_served()
    assert sizes == [4096] * 4


def test_a_client_that_has_spent_a_quarter_of_a_second_is_read_for_a_quarter_of_the_time(wire):
    wire.now_s += 100  # which saves up nothing beyond the burst
    wire.server.cost_s = 0.24
    wire.receive(pings(1))
    assert wire.is_served
    wire.receive(pings(2))
    assert not wire.is_served
    assert wire.until_served() == pytest.approx((0.24 * 1.75 - 0.25 + SLICE_S) / 0.25, abs=0.01)
    for number in range(3, 6):
        wire.receive(pings(number))
        assert not wire.is_served
        assert wire.until_served() == pytest.approx(0.24 * 3, abs=0.01)
    assert wire.pongs == [1, 2, 3, 4, 5]


def test_waiting_input_is_handled_as_fast_as_its_budget_allows(wire: Wire):
    wire.server.cost_s = 0.3
    wire.receive(pings(*range(4)))
    assert wire.pongs == [0]
    assert not wire.is_served
    earned_s = 0.25 + (3 * 0.3 + wire.until_served()) * 0.25
    assert wire.pongs == [0, 1, 2, 3]
    assert earned_s == pytest.approx(4 * 0.3, abs=0.01)


def test_beyond_the_budget_the_newest_message_of_a_topic_of_depth_1_replaces_the_others(wire: Wire):
    ros = wire.ros
    heard: list[tuple[str, bytes]] = []
    joy, log = (
        {"op": "advertise", "topic": topic, "type": "std_msgs/String", "queue_size": size}
        for topic, size in (("/joy", 1), ("/log", 100))
    )
    publish = b'{"op":"publish","topic":"%s","msg":{"data":"%d"}}'
    burst = b"".join(
        masked(Opcode.TEXT, publish % (topic, number))
        for number in range(3)
        for topic in (b"/joy", b"/log")
    )
    wire.receive(b"".join(masked(Opcode.TEXT, json.dumps(each).encode()) for each in (joy, log)))
    for publisher in ros.publishers:
        publisher.publish = lambda cdr, name=publisher.topic: heard.append((name, cdr[8:9]))
    wire.receive(burst)
    assert len(heard) == 6
    heard.clear()
    session = wire.connection.session
    session.turns.is_behind = True
    wire.receive(burst)
    assert heard == [("/log", b"0"), ("/log", b"1"), ("/log", b"2"), ("/joy", b"2")]
    assert session.replaced == 2


def test_a_client_without_budget_is_behind_until_it_has_more(wire: Wire):
    session = wire.connection.session
    wire.server.cost_s = 0.3
    wire.receive(pings(1, 2))
    assert session.turns.is_behind
    wire.server.cost_s = 0
    wire.until_served()
    wire.receive(pings(3))
    assert not session.turns.is_behind


def test_input_after_a_pause_may_be_as_old_as_the_pause(wire: Wire):
    session = wire.connection.session
    waited_s: list[float] = []

    def take(seconds: float) -> None:
        wire.take(seconds)
        waited_s.append(session.turns.waited_s())

    wire.server._pass_time = take

    def read(cost_s: float = 0.0) -> float:
        wire.server.cost_s = cost_s
        wire.receive(pings(1))
        return waited_s[-1]

    assert read() == 0
    assert read(0.3) == pytest.approx(0.3)  # by then it is as old
    paused_s = wire.until_served()
    assert paused_s > 0
    assert read() == pytest.approx(0.3 + paused_s)
    wire.take(0.1)
    assert read() == pytest.approx(0.4 + paused_s)  # there may be more behind it
    wire.run(0)  # nothing was read for some turns
    wire.take(5)
    assert read() == 0


def test_input_up_to_three_turns_after_a_pause_may_have_waited(wire: Wire):
    session = wire.connection.session
    waited_s: list[float] = []
    wire.server._pass_time = lambda cost_s: (
        wire.take(cost_s),
        waited_s.append(session.turns.waited_s()),
    )
    for turns in range(5):
        wire.server.cost_s = 0.3
        wire.receive(pings(1))
        wire.until_served()
        # the reader may run behind us, and TLS takes a turn to go on and one to read
        for _ in range(turns):
            wire.next_turn()
        wire.server.cost_s = 0.0
        wire.receive(pings(2))
        assert (waited_s[-1] > 0) == (turns < 4)
        wire.run(10)


def test_a_full_buffer_may_have_more_behind_it(wire: Wire):
    session = wire.connection.session
    wire.server.cost_s = 0.3
    wire.receive(pings(1))
    wire.until_served()
    wire.server.cost_s = 0.0
    late_s = session.turns.waited_s()
    for _ in range(10):
        wire.receive(masked(Opcode.TEXT, bytes(100_000))[: 16 * 1024])
        wire.next_turn()
        assert session.turns.waited_s() == pytest.approx(late_s)
    for _ in range(10):
        wire.receive(PONG)
    wire.take(5)
    wire.receive(PONG)
    assert session.turns.waited_s() == pytest.approx(0)


def test_reading_alone_is_paid_for(wire: Wire, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(inbound_module, "READ_COST_S", 0.1)
    chunk = masked(Opcode.TEXT, b"x" * 100_000)[: 16 * 1024]
    for _ in range(3):
        assert wire.is_served
        wire.receive(chunk)
    assert not wire.is_served


def test_a_read_costs_15_us(wire: Wire, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(inbound_module, "READ_COST_S", READ_COST_S)
    frame = masked(Opcode.TEXT, b"x" * 100_000)
    reads = 0
    while wire.is_served:
        wire.receive(frame[reads : reads + 1])
        reads += 1
    assert reads == pytest.approx(0.25 / 15e-6, rel=0.01)  # the time that may be spent at once


def test_time_that_is_spent_elsewhere_is_paid_for_too(wire: Wire):
    session = wire.connection.session
    session.turns.spend(0.3, wire.now_s)  # as the tasks of its calls do
    assert wire.is_served
    wire.receive(pings(1))
    assert not wire.is_served


def test_a_client_that_returns_has_only_the_time_of_its_address(wire, monkeypatch):
    server = wire.server._server
    wire.server.leaving_cost_s = 0.6  # closing what it had open took so long
    wire.connection.connection_lost(None)
    again = Wire(server, monkeypatch)
    assert not again.is_served
    assert again.until_served() > 0.3
    again.connection.connection_lost(None)


STOP = b'{"op":"stop","id":"s"}'
STOP_IN_CBOR = b"\xa1\x62op\x64stop"


@pytest.mark.parametrize("cost_s", [0.001, 0.3], ids=["in its turn", "behind"])
@pytest.mark.parametrize(
    "stop", [masked(Opcode.TEXT, STOP), masked(Opcode.BINARY, STOP_IN_CBOR)], ids=["JSON", "CBOR"]
)
def test_a_stop_is_carried_out_once_and_before_all_that_came_earlier(wire, cost_s, stop):
    wire.server.cost_s = cost_s
    wire.receive(pings(*range(10)) + stop + pings(10, 11))
    assert wire.carried_out[:2] == ["other", 0]
    wire.until_served()
    assert wire.carried_out == ["other", *range(12)]
    assert wire.server.overtaken == wire.server.received[1:11]


def test_a_stop_does_not_wait_for_the_budget_of_its_client(wire: Wire):
    wire.server.cost_s = 0.3
    wire.receive(pings(*range(3)))
    wire.receive(pings(3) + masked(Opcode.TEXT, STOP))
    assert wire.carried_out == [0, "other"]
    wire.receive(masked(Opcode.TEXT, STOP) + pings(4))
    assert wire.carried_out == [0, "other", "other"]
    wire.until_served()
    assert wire.carried_out == [0, "other", "other", *range(1, 5)]
    assert wire.server.overtaken == wire.server.received[3:6]


@pytest.mark.parametrize(
    "other",
    [
        b'{"op":"ping","id":"stop"}',
        b'{"op":"ping","value":"{\\"op\\":\\"stop\\"}"}',
        b'{"op":"stop","op":"ping"}',
        b'["op","stop"]',
        b'{"op":"stop"',
        STOP[:-1] + b" " * 1024 + b"}",
    ],
)
def test_a_long_message_or_one_that_only_contains_the_word_waits_for_its_turn(wire, other):
    wire.server.cost_s = 0.005
    wire.receive(pings(1, 2) + masked(Opcode.TEXT, other))
    assert wire.carried_out == [1]
    wire.until_served()
    assert wire.carried_out[:2] == [1, 2]
    assert len(wire.carried_out) == 3
    assert wire.server.overtaken == []


def test_a_stop_before_authentication_waits_for_its_turn(wire: Wire):
    wire.connection.session.sign_in(None)
    wire.server.cost_s = 0.005
    wire.receive(pings(1, 2) + masked(Opcode.TEXT, STOP))
    wire.until_served()
    assert wire.carried_out == [1, 2, "other"]


def test_a_large_message_that_a_stop_has_overtaken_is_so_when_it_is_carried_out(wire, monkeypatch):
    seen: list[tuple[str, bool]] = []

    def note(session: RosbridgeSession, op: str, *_: object, **__: object) -> None:
        seen.append((op, session.turns.is_overtaken))

    monkeypatch.setattr(RosbridgeSession, "answer", note)
    large = masked(Opcode.TEXT, padded_ping(8 * 1024 + 1))
    wire.receive(large + pings(1) + masked(Opcode.TEXT, STOP) + pings(2))
    wire.until_served()
    assert seen == [("stop", False), ("pong", True), ("pong", True), ("pong", False)]


@pytest.mark.parametrize(("size", "count"), [(20, 4096), (4000, 64)])
def test_input_of_a_client_without_time_is_read_ahead_up_to_a_limit(wire, size, count):
    wire.server.cost_s = 0.3
    wire.receive(pings(0, 1))
    wire.server.cost_s = 0.0
    frame = masked(Opcode.TEXT, padded_ping(size)) if size > 1000 else pings(2)
    sent = 2
    while wire.transport.is_read:
        number = len(wire.connection.get_buffer(-1)) // len(frame)
        wire.receive(frame * number)
        sent += number
        while wire.connection.spending.turns._is_due:
            wire.next_turn()
    assert sent == pytest.approx(count, rel=0.15)
    wire.until_served()
    assert len(wire.server.received) == sent


def test_the_driver_goes_first_and_the_greediest_client_last(wire: Wire):
    inbound = wire.connection._inbound
    assert inbound.rank(wire.now_s) == 1
    wire.connection.spending.spend(0.124, wire.now_s)
    assert inbound.rank(wire.now_s) == 1
    wire.connection.spending.spend(0.002, wire.now_s)
    assert inbound.rank(wire.now_s) == 2
    wire.server._router.is_driven_by = lambda _: True
    assert inbound.rank(wire.now_s) == 0


def test_the_driver_waits_for_its_budget_and_not_for_others_of_its_address(wire: Wire):
    session = wire.connection.session
    neighbour = wire.server.connections.budgets.open("127.0.0.1")
    neighbour.spend(100, wire.now_s)
    wire.server.cost_s = 0.001
    wire.receive(pings(1))
    wire.receive(pings(2))
    assert wire.pongs == [1]
    wire.server._router.is_driven_by = lambda _: True
    wire.receive(pings(3))
    assert wire.pongs == [1, 2, 3]
    assert wire.is_served
    wire.receive(pings(4))
    assert not session.turns.is_behind
    wire.run(0)
    wire.take(5)
    assert session.turns.waited_s() >= 5
    wire.server.cost_s = 3
    wire.receive(pings(5, 6))
    wire.run(0)
    assert wire.pongs == [1, 2, 3, 4, 5]
    neighbour.close()


def publish(number: int) -> bytes:
    text = b'{"op":"publish","topic":"/log","type":"std_msgs/String","msg":{"data":"%d"}}' % number
    return masked(Opcode.TEXT, text)


def leave(wire: Wire, how: str) -> None:
    """Have the client go that has left some things behind."""
    match how:
        case "closed":  # unread input is before the end
            wire.transport.tcp_state = 8
            wire.pass_time(0.25)
        case "end":
            assert wire.connection.eof_received()
        case "close frame":
            wire.receive(masked(Opcode.CLOSE, (1000).to_bytes(2, "big")))


@pytest.mark.parametrize("how", ["closed", "end", "close frame"])
def test_only_publishes_of_a_client_that_left_without_time_are_carried_out(wire: Wire, how: str):
    wire.transport.tcp_state = 1
    wire.server.cost_s = 0.3
    wire.receive(pings(1, 2) + publish(1) + pings(3))
    wire.pass_time(0.25)
    wire.server.cost_s = 0.001
    leave(wire, how)
    if how == "closed":  # which is read on
        wire.receive(pings(4) + publish(2))
    while wire.connection._inbound:
        wire.next_turn()
    assert wire.carried_out == [1, "other", "other"][: 3 if how == "closed" else 2]
    assert wire.server.overtaken == wire.server.received[1:]
    assert wire.transport.is_aborted == (how == "end")


def test_a_publish_in_fragments_that_a_client_leaves_is_carried_out(wire: Wire):
    first, last = b'{"op":"publish","topic":"/log",', b'"type":"std_msgs/String"}'
    fragment = b'{"op":"fragment","id":"f","num":1,"total":2,"data":"}"}'
    wire.transport.tcp_state = 1
    wire.server.cost_s = 0.3
    wire.receive(pings(1, 2))
    wire.receive(masked(Opcode.TEXT, first, fin=False) + masked(Opcode.CONT, last) + pings(3))
    wire.receive(masked(Opcode.TEXT, fragment))
    wire.server.cost_s = 0.001
    leave(wire, "closed")
    while wire.connection._inbound:
        wire.next_turn()
    assert wire.server.received[1:] == [first + last, fragment]


def test_the_rest_of_a_client_is_carried_out_for_a_second_at_most(wire: Wire):
    wire.server.cost_s = 0.3
    wire.receive(pings(1) + b"".join(map(publish, range(50))))
    wire.transport.tcp_state = 8
    wire.pass_time(0.25)
    wire.pass_time(0.99)
    assert not wire.transport.is_aborted
    wire.pass_time(0.02)
    assert wire.transport.is_aborted
    assert len(wire.server.received) < 5


def test_all_that_a_client_has_sent_in_time_is_carried_out_before_its_end(wire: Wire):
    wire.server.cost_s = 0.005
    wire.receive(pings(*range(10)))
    assert wire.connection.eof_received()
    assert not wire.transport.is_aborted
    while wire.handles:
        wire.next_turn()
    assert wire.pongs == list(range(10))
    assert wire.transport.is_aborted


@pytest.mark.parametrize("is_closing", [False, True])
def test_a_client_of_which_nothing_is_left_to_do_ends_at_once(wire: Wire, *, is_closing: bool):
    if is_closing:
        wire.server.cost_s = 0.3
        wire.receive(pings(1, 2))
        wire.connection.close(1001, "shutting down")
    assert not wire.connection.eof_received()


@pytest.mark.parametrize(("cost_s", "count"), [(0.001, 9), (0.011, 2)])
def test_the_rest_of_a_lost_client_is_carried_out_for_20_ms(wire: Wire, cost_s: float, count: int):
    wire.server.cost_s = 0.005
    wire.receive(b"".join(map(publish, range(10))))
    assert len(wire.server.received) == 1
    wire.server.cost_s = cost_s
    wire.connection.connection_lost(None)
    assert len(wire.server.received) == 1 + count


def test_the_input_of_a_lost_client_is_not_carried_out_later(wire: Wire):
    wire.server.cost_s = 0.3
    wire.receive(pings(1, 2, 3))
    wire.connection.connection_lost(None)
    while wire.handles:
        wire.next_turn()
    assert wire.pongs == [1]


def test_messages_in_one_packet_with_a_close_are_carried_out_before_it_is_answered(wire: Wire):
    wire.server.cost_s = 0.02
    wire.receive(pings(*range(10)) + masked(Opcode.CLOSE, (1000).to_bytes(2, "big")))
    while not wire.transport.unsent.endswith(bytes((0x80 | Opcode.CLOSE, 2)) + b"\x03\xe8"):
        wire.connection.tick(wire.now_s)
        wire.next_turn()
    assert len(wire.server.received) == 10


def test_input_that_waits_when_the_gateway_closes_is_not_carried_out(wire: Wire):
    wire.server.cost_s = 0.1
    wire.receive(pings(*range(5)))
    wire.connection.close(1001, "shutting down")
    while wire.handles:
        wire.next_turn()
    assert wire.pongs == [0]
    wire.pass_time(1.01)
    assert wire.transport.is_aborted


def test_pings_are_answered_in_their_turn_and_so_are_those_behind_a_slice(wire: Wire):
    wire.server.cost_s = 0.01
    wire.receive(pings(1, 2) + masked(Opcode.PING, b"hello"))
    wire.until_served()
    assert wire.pongs == [1, 2]
    assert wire.transport.unsent.endswith(bytes((0x80 | Opcode.PONG, 5)) + b"hello")


def test_a_client_that_pings_and_does_not_read_is_cut_off_at_64_kib_of_pongs(wire: Wire):
    wire.connection.pause_writing()
    while not wire.transport.is_aborted:
        assert len(wire.transport.unsent) <= 64 * 1024
        wire.receive(PING)
    assert len(wire.transport.unsent) > 64 * 1024


def test_pongs_that_are_taken_do_not_add_up(wire: Wire):
    for _ in range(3):
        wire.connection.pause_writing()
        while len(wire.transport.unsent) < 40 * 1024:
            wire.receive(PING)
        wire.transport.unsent = b""
        wire.connection.resume_writing()
    assert not wire.transport.is_aborted


class Waiting:
    """An entry that waits in a queue, of any size."""

    is_being_encoded = False
    arrived_ns = 0

    def __init__(self, size: int) -> None:
        self.size = size

    def frame(self) -> bytes:
        raise AssertionError("nothing is sent")


async def test_a_handshake_has_5_s(serve: Serve, monkeypatch: pytest.MonkeyPatch):
    async with serve() as served:
        wire = Wire(served.server, monkeypatch, is_upgraded=False)
        wire.pass_time(4.99)
        assert not wire.transport.is_aborted
        wire.pass_time(0.02)
        assert wire.transport.is_aborted


async def test_a_page_has_35_s_to_be_read_and_its_connection_a_second_to_close(serve, monkeypatch):
    async with serve() as served:
        wire = Wire(served.server, monkeypatch, is_upgraded=False)
        wire.receive(b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n")
        for _ in range(10):
            wire.pass_time(3.49, taken=10)
        wire.pass_time(0.09)
        assert wire.transport.unsent
        wire.pass_time(0.02)
        wire.pass_time(0.99)
        assert not wire.transport.is_aborted
        wire.pass_time(0.02)
        assert wire.transport.is_aborted
        quick = Wire(served.server, monkeypatch, is_upgraded=False)
        quick.receive(b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n")
        quick.pass_time(0.1, taken=10_000)
        quick.pass_time(1.01)
        assert quick.transport.is_aborted


def test_the_closing_handshake_has_a_second(wire: Wire):
    wire.connection.close(1000, "enough")
    wire.pass_time(0.99)
    assert not wire.transport.is_aborted
    wire.pass_time(0.02)
    assert wire.transport.is_aborted


def test_over_half_of_the_send_queue_may_be_in_use_for_30_s(wire: Wire):
    wire.transport.unsent = b"x" * 100
    wire.connection.pause_writing()
    session = wire.connection.session
    queue = session.outbox.open_queue(100, None)
    queue.put(Waiting(4 * MIB))
    for _ in range(2):
        wire.pass_time(29.99, taken=1)
    queue.put(Waiting(1))
    wire.pass_time(0.1, taken=1)
    wire.pass_time(29.99, taken=1)
    assert set(wire.transport.unsent) == {ord("x")}
    wire.pass_time(0.02, taken=1)
    assert (4503).to_bytes(2, "big") + b"slow consumer: over half of" in wire.transport.unsent


def test_answers_alone_beyond_the_send_queue_end_a_connection(wire: Wire):
    wire.connection.pause_writing()
    session = wire.connection.session
    for _ in range(9):  # the oldest does not count
        session.outbox.put_control(bytes(MIB))
    wire.pass_time(0.1)
    assert wire.transport.unsent == b""
    session.outbox.put_control(b"x")
    wire.pass_time(0.1)
    assert (4503).to_bytes(2, "big") + b"slow consumer: answers alone" in wire.transport.unsent
