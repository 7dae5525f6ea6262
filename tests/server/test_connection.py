# SPDX-License-Identifier: Apache-2.0
"""One connection without a socket: its transport, its clock and its timers are ours."""

import asyncio
import socket
from collections.abc import AsyncIterator, Callable
from types import SimpleNamespace
from typing import Any

import pytest
from websockets.frames import Opcode

from gateway.server import connection as module
from gateway.server.connection import Connection
from gateway.server.server import Server
from tests.server.conftest import Serve
from tests.server.test_server import masked, upgrade

MIB = 1024**2
PONG = masked(Opcode.PONG, b"")
PING = masked(Opcode.PING, b"x" * 125)
CHUNK = masked(Opcode.TEXT, b"x" * (16 * 1024 - 8))  # no JSON, which is answered


class Transport(asyncio.Transport):
    """Keeps what is written, for ever or until it is `taken`."""

    def __init__(self) -> None:
        super().__init__()
        self.unsent = b""
        self.is_read = True
        self.is_aborted = False
        self.high_water_bytes: int | None = None
        self.options: dict[tuple[int, int], int] = {}

    def get_extra_info(self, name: str, default: Any = None) -> Any:
        return {"peername": ("127.0.0.1", 1), "socket": self}.get(name, default)

    def setsockopt(self, level: int, option: int, value: int) -> None:
        self.options[level, option] = value

    def set_write_buffer_limits(self, high: int | None = None, low: int | None = None) -> None:
        self.high_water_bytes = high

    def get_write_buffer_size(self) -> int:
        return len(self.unsent)

    def write(self, data: bytes | bytearray | memoryview) -> None:
        self.unsent += data

    def pause_reading(self) -> None:
        self.is_read = False

    def resume_reading(self) -> None:
        self.is_read = True

    def is_closing(self) -> bool:
        return self.is_aborted

    def abort(self) -> None:
        self.is_aborted = True


class Acceptor:
    """The server that a connection comes to, which takes no note of it."""

    def __init__(self, server: Server) -> None:
        self._server = server

    def __getattr__(self, name: str) -> Any:
        return getattr(self._server, name)

    def arrive(self, connection: Connection) -> bool:
        return True


class Wire:
    """A connection, what it is connected to, and the time."""

    def __init__(
        self, server: Server, monkeypatch: pytest.MonkeyPatch, *, is_upgraded: bool = True
    ) -> None:
        self.now_s = 1000.0
        self.timers: list[tuple[float, Callable[[], None]]] = []
        clock = SimpleNamespace(
            monotonic=lambda: self.now_s, monotonic_ns=lambda: round(self.now_s * 1e9)
        )
        loop = SimpleNamespace(call_later=lambda delay, call: self.timers.append((delay, call)))
        monkeypatch.setattr(module, "time", clock)
        monkeypatch.setattr(module, "asyncio", SimpleNamespace(get_running_loop=lambda: loop))
        self.transport = Transport()
        self.connection = Connection(Acceptor(server))
        self.connection.connection_made(self.transport)
        if not is_upgraded:
            return
        self.receive(upgrade("Host: localhost"))
        assert b" 101 " in self.transport.unsent
        self.transport.unsent = b""

    def receive(self, data: bytes) -> None:
        buffer = self.connection.get_buffer(-1)
        buffer[: len(data)] = data
        self.connection.buffer_updated(len(data))

    def pass_time(self, seconds: float, *, taken: int = 0, heard: bytes = b"") -> None:
        """Let time pass, in which the peer takes some bytes and sends some."""
        self.now_s += seconds
        self.transport.unsent = self.transport.unsent[taken:]
        if heard:
            self.receive(heard)
        self.connection.tick(self.now_s)

    def receive_much(self, nbytes: int) -> None:
        for _ in range(nbytes // len(CHUNK)):
            self.receive(CHUNK)
        self.transport.unsent = b""


@pytest.fixture
async def wire(serve: Serve, monkeypatch: pytest.MonkeyPatch) -> AsyncIterator[Wire]:
    async with serve() as served:
        wire = Wire(served.server, monkeypatch)
        yield wire
        wire.connection.connection_lost(None)


def test_so_much_is_read_at_a_time_that_others_get_their_turn(wire: Wire):
    assert len(wire.connection.get_buffer(-1)) == 16 * 1024


def test_so_much_waits_in_the_transport_and_the_rest_where_it_can_be_dropped(wire: Wire):
    assert wire.transport.high_water_bytes == 64 * 1024


def test_little_waits_in_the_kernel_and_not_for_long(wire: Wire):
    assert wire.transport.options == {
        (socket.IPPROTO_TCP, socket.TCP_NOTSENT_LOWAT): 16 * 1024,
        (socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT): 5000,  # ms
    }


def test_a_message_of_10_mib_is_taken_and_a_larger_one_ends_the_connection(wire: Wire):
    largest = masked(Opcode.TEXT, b"x" * (10 * MIB))
    for start in range(0, len(largest), 16 * 1024):
        wire.receive(largest[start : start + 16 * 1024])
    assert b"bad_json" in wire.transport.unsent
    assert wire.connection.session is not None
    wire.receive(masked(Opcode.TEXT, b"x" * (10 * MIB + 1))[: 16 * 1024])
    assert (1009).to_bytes(2, "big") in wire.transport.unsent


def test_who_sends_more_than_4_mib_at_once_is_read_again_at_4_mib_a_second(wire: Wire):
    wire.now_s += 100  # which saves up nothing beyond the burst
    wire.receive_much(4 * MIB)
    assert wire.transport.is_read
    wire.receive_much(2 * MIB)
    assert not wire.transport.is_read
    pause_s, read_again = wire.timers[-1]
    assert pause_s == pytest.approx(0.5)
    wire.now_s += pause_s
    read_again()
    assert wire.transport.is_read
    wire.now_s += 0.25
    wire.receive_much(2 * MIB)
    assert wire.timers[-1][0] == pytest.approx(0.25)


def test_who_has_gone_meanwhile_is_not_read_again(wire: Wire):
    wire.receive_much(5 * MIB)
    wire.connection.abort()
    wire.timers[-1][1]()
    assert not wire.transport.is_read


def test_who_sends_pings_and_reads_nothing_is_cut_off_at_64_kib_of_pongs(wire: Wire):
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


def test_who_is_silent_for_5_s_is_sent_a_ping_and_has_5_s_to_answer(wire: Wire):
    wire.pass_time(4.99)
    assert wire.transport.unsent == b""
    wire.pass_time(0.02)
    assert wire.transport.unsent == bytes((0x80 | Opcode.PING, 0))
    wire.pass_time(4.99, taken=2, heard=PONG)
    assert wire.transport.unsent == b""
    wire.pass_time(5.01)
    wire.pass_time(4.99, taken=2)
    assert wire.transport.unsent == b""
    wire.pass_time(0.02)
    assert (4408).to_bytes(2, "big") + b"no pong within 5 s" in wire.transport.unsent


def test_a_ping_that_waits_behind_what_is_being_taken_has_its_time_yet(wire: Wire):
    wire.transport.unsent = b"x" * 100
    wire.connection.pause_writing()
    for _ in range(6):
        wire.pass_time(4.9, taken=1)
    assert b"no pong" not in wire.transport.unsent
    assert not wire.transport.is_aborted


def test_the_closing_handshake_has_a_second(wire: Wire):
    wire.connection.close(1000, "enough")
    wire.pass_time(0.99)
    assert not wire.transport.is_aborted
    wire.pass_time(0.02)
    assert wire.transport.is_aborted


def test_who_takes_nothing_for_5_s_is_cut_off(wire: Wire):
    wire.transport.unsent = b"x" * 100
    wire.connection.pause_writing()
    for taken in (1, 1, 0):
        wire.pass_time(4.99, taken=taken, heard=PONG)
        assert not wire.transport.is_aborted
    wire.pass_time(0.02, heard=PONG)
    assert wire.transport.is_aborted


def test_over_half_of_the_send_queue_may_be_in_use_for_5_s(wire: Wire):
    wire.transport.unsent = b"x" * 100
    wire.connection.pause_writing()
    session = wire.connection.session
    assert session is not None
    queue = session.outbox.open_queue(100, None)
    queue.put(Waiting(4 * MIB))
    for _ in range(2):
        wire.pass_time(4.99, taken=1, heard=PONG)
    queue.put(Waiting(1))
    wire.pass_time(0.1, taken=1, heard=PONG)
    wire.pass_time(4.99, taken=1, heard=PONG)
    assert set(wire.transport.unsent) == {ord("x")}
    wire.pass_time(0.02, taken=1, heard=PONG)
    assert (4503).to_bytes(2, "big") + b"slow consumer: over half of" in wire.transport.unsent


def test_answers_alone_beyond_the_send_queue_end_a_connection(wire: Wire):
    wire.connection.pause_writing()
    session = wire.connection.session
    assert session is not None
    for _ in range(9):  # the oldest does not count
        session.outbox.put_control(bytes(MIB))
    wire.pass_time(0.1)
    assert wire.transport.unsent == b""
    session.outbox.put_control(b"x")
    wire.pass_time(0.1)
    assert (4503).to_bytes(2, "big") + b"slow consumer: answers alone" in wire.transport.unsent
