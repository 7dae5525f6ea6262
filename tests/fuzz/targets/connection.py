# SPDX-License-Identifier: Apache-2.0
"""The bytes of a socket: HTTP requests, WebSocket frames, in reads of any size."""

import asyncio
import logging
import re
from typing import Any

from websockets.frames import Frame, Opcode
from websockets.streams import StreamReader

from gateway.access.audit import Audit
from gateway.access.authentication import Authentication
from gateway.access.permissions import Policy
from gateway.access.tokens import Token, Tokens, digest_of
from gateway.access.web_rules import WebRules
from gateway.config.access import AccessConfig
from gateway.transport.admission import Admission, RoomFor, everybody
from gateway.transport.connection import Connection
from gateway.transport.front import Fronts
from gateway.transport.server import Server
from tests.fuzz import seeds
from tests.fuzz.gateway_in_memory import LIMITS, World, run_in_a_loop, turns
from tests.fuzz.target import Target, check

STATUSES = frozenset({101, 200, 400, 403, 404, 405, 421, 426, 431})
# docs/reference/errors.md. 1000 and those without a code answer the client's own
CLOSE_CODES = frozenset({1000, 1001, 1002, 1007, 1008, 1009, 1011, 1013, 4401, 4403, 4503})
UPGRADE = (
    b"GET / HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
    b"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
)
CUTS = (16_384, 1, 2, 7, 100, 4096)


TEXT = "r2g_known"
TOKENS = Tokens((Token(name="pad", role="viewer", created="", sha256=digest_of(TEXT).hex()),))


def guarded(room_for: RoomFor, rules: WebRules) -> Admission:
    """Return an admission of clients with a token, each time without a memory of failures."""
    config = AccessConfig()
    audit = Audit(lambda: 0, level=logging.DEBUG)
    return Admission(Authentication(TOKENS, Policy(config), None), config, audit, room_for, rules)


class Transport(asyncio.Transport):
    """Keeps what is written. Its socket takes everything."""

    def __init__(self) -> None:
        super().__init__()
        self.written = b""
        self.is_read = True
        self.is_over = False

    def get_extra_info(self, name: str, default: Any = None) -> Any:
        return {"peername": ("127.0.0.1", 1)}.get(name, default)

    def set_write_buffer_limits(self, high: int | None = None, low: int | None = None) -> None:
        pass

    def get_write_buffer_size(self) -> int:
        return 0

    def write_eof(self) -> None:
        pass

    def write(self, data: bytes | bytearray | memoryview) -> None:
        self.written += data

    def pause_reading(self) -> None:
        self.is_read = False

    def resume_reading(self) -> None:
        self.is_read = True

    def is_closing(self) -> bool:
        return self.is_over

    def abort(self) -> None:
        self.is_over = True

    close = abort


def run(data: bytes) -> None:
    """Take the size of the reads from the first byte.

    Of the second, the lowest bit says whether to upgrade first, the next whether a token is needed.
    """
    size = CUTS[data[0] % len(CUTS)] if data else 1
    options = data[1] if len(data) > 1 else 0
    is_upgraded = bool(options & 1)
    sent = data[2:]

    async def talk(world: World) -> None:
        server = Server(
            world.router,
            Fronts(world.front),
            limits=LIMITS,
            web_rules=WebRules(["localhost"]),
            trusted_proxies=["127.0.0.0/8"],
            admission=guarded if options & 2 else everybody,
        )
        transport = Transport()
        connection = Connection(server)
        connection.connection_made(transport)
        if is_upgraded:
            receive(connection, UPGRADE + b"\r\n")
            await turns()  # input is handled in the next one
            check(b" 101 " in transport.written, transport.written)
        for start in range(0, len(sent), size):
            while not transport.is_read:  # noqa: ASYNC110  # what waits goes on in each turn
                await asyncio.sleep(0)
            if transport.is_over:
                break
            receive(connection, sent[start : start + size])
        await turns()
        is_client = connection.session is not None
        connection.eof_received()
        connection.connection_lost(None)
        check_answer(transport.written, is_client=is_client)

    run_in_a_loop(talk)


def receive(connection: Connection, data: bytes) -> None:
    connection.get_buffer(-1)[: len(data)] = data
    connection.buffer_updated(len(data))


def check_answer(written: bytes, *, is_client: bool) -> None:
    if not written:
        check(not is_client)
        return
    found = re.match(rb"HTTP/1\.1 (\d{3}) [^\r]+\r\n(?:[^\r\n]+\r\n)*\r\n", written)
    check(found is not None, "no HTTP response", written[:200])
    assert found is not None
    status, rest = int(found[1]), written[found.end() :]
    check(status in STATUSES, "not a documented status", status)
    if status == 101:
        check_frames(rest)
        return
    length = re.search(rb"content-length: (\d+)", found[0], re.IGNORECASE)
    check(length is not None and len(rest) in {0, int(length[1])}, "not one response", rest)


def check_frames(wire: bytes) -> None:
    reader = StreamReader()
    reader.feed_data(wire)
    reader.feed_eof()
    is_closed = False
    while reader.buffer:
        parser = Frame.parse(reader.read_exact, mask=False)
        try:
            next(parser)
        except StopIteration as stop:
            frame = stop.value
        else:
            check(False, "an incomplete frame")
        # RFC 6455, 5.5.1: no data after a close. Pings are still answered
        check(not is_closed or frame.opcode is Opcode.PONG, "data after a close")
        if frame.opcode is Opcode.TEXT:
            bytes(frame.data).decode()
        elif frame.opcode is Opcode.CLOSE:
            is_closed = True
            if frame.data:
                code = int.from_bytes(bytes(frame.data[:2]), "big")
                check(code in CLOSE_CODES or code >= 3000, "not a documented close code", code)


def masked(opcode: Opcode, data: bytes, *, fin: bool = True) -> bytes:
    """Return a frame of a client, with a mask that changes nothing."""
    head = bytes(((0x80 if fin else 0) | opcode,))
    size = len(data)
    lengths = bytes((0x80 | size,)) if size < 126 else b"\xfe" + size.to_bytes(2, "big")
    return head + lengths + bytes(4) + data


def corpus() -> list[bytes]:
    requests = [
        UPGRADE + b"\r\n" + masked(Opcode.TEXT, b'{"op":"ping"}'),
        UPGRADE + b"Origin: http://evil.example\r\n\r\n",
        UPGRADE + b"Authorization: Bearer a\r\nSec-WebSocket-Protocol: bearer.b\r\n\r\n",
        b"GET /healthz HTTP/1.1\r\nHost: 127.0.0.1:9090\r\n\r\n",
        b"HEAD /?token=a HTTP/1.1\r\nHost: [::1]\r\n\r\n",
        b"POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 2\r\n\r\nhi",
        b"GET /nothing HTTP/1.1\r\nHost: elsewhere.example\r\n\r\n",
        b"GET / HTTP/1.1\r\nHost: [::1\r\n\r\n",
        b"GET //[a HTTP/1.1\r\nHost: localhost\r\n\r\n",
        b"GET / HTTP/1.1\r\nHost: localhost\r\nHost: localhost\r\n\r\n",
        b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03",
    ]
    frames = [
        *(masked(Opcode.TEXT, each) for each in seeds.frames()[::6]),
        masked(Opcode.BINARY, b'{"op":"ping","id":1}') + masked(Opcode.PING, b"x"),
        masked(Opcode.TEXT, b'{"op":', fin=False) + masked(Opcode.CONT, b'"hello"}'),
        masked(Opcode.CLOSE, b"\x03\xe8bye") + masked(Opcode.TEXT, b'{"op":"ping"}'),
        masked(Opcode.TEXT, b'{"op":"\xff"}'),
        masked(Opcode.PONG, b"") + b"\xc1\x80\0\0\0\0",
        b"\x81\xff\x00\x00\x00\x00\xff\xff\xff\xff\0\0\0\0",
    ]
    token = masked(Opcode.TEXT, b'{"op":"auth","id":1,"token":"r2g_known"}')
    wrong = masked(Opcode.TEXT, b'{"op":"auth","token":"r2g_wrong"}')
    allowed = masked(Opcode.TEXT, b'{"op":"subscribe","topic":"/camera"}')
    forbidden = masked(Opcode.TEXT, b'{"op":"publish","topic":"/a","type":1,"msg":{}}')
    bearer = UPGRADE + b"Authorization: Bearer r2g_known\r\nForwarded: for=10.0.0.1\r\n\r\n"
    return [
        b"\x00\x03" + allowed + token + allowed + forbidden + token,
        b"\x00\x03" + token + forbidden + wrong,
        b"\x00\x02" + bearer + allowed + token + wrong,
        *(b"\x00\x00" + each for each in requests),
        b"\x01\x00" + requests[0],
        *(b"\x00\x01" + each for each in frames),
        b"\x02\x01" + frames[-5],
    ]


TARGET = Target("a socket gets documented statuses, frames and close codes", run, corpus)
