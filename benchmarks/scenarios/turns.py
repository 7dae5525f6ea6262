# SPDX-License-Identifier: Apache-2.0
"""The longest turn of the event loop while one large frame comes in, by a socket, and is served.

For so long every other client waits. It is wall time, which takes a quiet machine, and CPU time of
the loop's thread next to it. The first round of a frame also makes the
codecs and the publisher of its type.
"""

import asyncio
import contextlib
import gc
import selectors
import socket
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any, Final, NamedTuple

from benchmarks.figures import Figure
from benchmarks.hostile_frames import HostileFrame, large_frames, plain_frames
from benchmarks.plan import Plan
from benchmarks.servers import NO_INBOUND_LIMITS
from gateway.backports import Runner
from gateway.codec.cbor_reader import is_cbor
from gateway.codec.types import Types
from gateway.config.limits import Limits
from gateway.core.rosapi import interfaces_prefix
from gateway.core.router import Router
from gateway.fronts.rosbridge.front import RosbridgeFront
from gateway.memory import keep_large_blocks
from gateway.sources.rclpy import RosOptions, open_ros
from gateway.transport.front import Fronts
from gateway.transport.listening import ListenPort
from gateway.transport.server import Server
from schemas.installed import InstalledDefinitions, installed_prefixes
from schemas.table import Table

BAR_MS: Final = 20.0

_SCENARIO: Final = "turns"
_REPEATS: Final = 4
_TIMEOUT_S: Final = 60
_TEXT, _BINARY = b"\x81", b"\x82"
_UPGRADE: Final = (
    b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    b"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
)
_PING: Final = b'{"op":"ping","id":"behind it"}'
_PONG: Final = b'"id":"behind it"'


class _Turns(selectors.DefaultSelector):
    """The selector of a loop, which knows how long the loop has not asked it."""

    longest_s = 0.0
    busiest_s = 0.0  # in CPU time
    _since_s: float | None = None
    _since_cpu_s = 0.0

    def select(self, timeout: float | None = None) -> list[tuple[selectors.SelectorKey, int]]:
        """Wait. Between two calls is one turn."""
        if self._since_s is not None:
            self.longest_s = max(self.longest_s, time.perf_counter() - self._since_s)
            self.busiest_s = max(self.busiest_s, time.thread_time() - self._since_cpu_s)
        try:
            return super().select(timeout)
        finally:
            self._since_s, self._since_cpu_s = time.perf_counter(), time.thread_time()


def measure(_: Plan) -> list[Figure]:
    """Print a table and return the figures."""
    keep_large_blocks()  # as the gateway does
    turns = _Turns()
    with Runner(loop_factory=partial(asyncio.SelectorEventLoop, turns)) as runner:
        return runner.run(_measure(turns))


async def _measure(turns: _Turns) -> list[Figure]:
    types = Types(InstalledDefinitions([*installed_prefixes(), interfaces_prefix()]))
    limits = Limits(**NO_INBOUND_LIMITS)
    async with open_ros(RosOptions()) as ros:
        with ThreadPoolExecutor(1) as workers:
            router = Router(
                ros, types, Table.load(), limits=limits, workers=workers, version="benchmark"
            )
            with contextlib.closing(router):
                server = Server(router, Fronts(RosbridgeFront(router)), limits=limits)
                async with server.listening(["127.0.0.1"], ListenPort(0)) as (((_, port),),):
                    gc.freeze()  # as the gateway does when it is ready
                    rows = [
                        await asyncio.to_thread(_rounds, turns, port, frame) for frame in _frames()
                    ]
                    gc.unfreeze()
    print(f"ms of the longest turn for one frame, best of {_REPEATS}, of CPU, and the first time;")
    print("ms until what the client sent behind it is answered, and the beginning of its answer")
    print(f"  {'ms':>8}{'CPU':>8}{'first':>8}{'in all':>8}{'bytes':>10}  frame")
    figures = []
    for row in sorted(rows, key=lambda row: -row.held_ms):
        mark = "  OVER" if row.held_ms > BAR_MS else ""
        times = f"{row.held_ms:8.1f}{row.cpu_ms:8.1f}{row.first_ms:8.1f}{row.all_ms:8.0f}"
        text = f"{row.frame.name[:60]}{mark}  {row.answer}"
        print(f"  {times}{len(row.frame.data):10}  {text}")
        figures.append(Figure(_SCENARIO, row.frame.name, row.held_ms, "ms"))
    return figures


def _frames() -> Iterator[HostileFrame]:
    yield from large_frames()
    yield from plain_frames()


class _Row(NamedTuple):
    held_ms: float
    cpu_ms: float
    first_ms: float
    all_ms: float
    frame: HostileFrame
    answer: str


def _rounds(turns: _Turns, port: int, frame: HostileFrame) -> _Row:
    """Send a frame again and again."""
    kind = _BINARY if is_cbor(frame.data) else _TEXT
    wire = _masked(kind, frame.data) + _masked(_TEXT, _PING)
    rounds: list[tuple[float, float, float]] = []
    answer = b""
    with socket.create_connection(("127.0.0.1", port), _TIMEOUT_S) as client:
        client.sendall(_UPGRADE)
        client.recv(4096)
        for _ in range(1 + _REPEATS):
            time.sleep(0.05)  # a turn that has nothing to do with the frame ends
            turns.longest_s = turns.busiest_s = 0.0
            started_s = time.perf_counter()
            client.sendall(wire)
            answer = _until_pong(client)
            took_s = time.perf_counter() - started_s
            rounds.append((turns.longest_s * 1e3, turns.busiest_s * 1e3, took_s * 1e3))
    first, *others = rounds
    held, busy, took = map(min, zip(*others, strict=True))
    return _Row(held, busy, first[0], took, frame, _readable(answer))


def _until_pong(client: socket.socket) -> bytes:
    answer = b""
    while _PONG not in answer[-4096:]:
        chunk = client.recv(1 << 20)
        if not chunk:
            break
        answer += chunk
    return answer


def _readable(answer: bytes) -> str:
    text = answer[2:].decode(errors="replace")
    start = text.find('"msg":')
    return "" if "status" not in text or start < 0 else text[start + 7 : start + 87]


def _masked(kind: bytes, payload: bytes) -> bytes:
    """Return a frame whose mask is zero: to take it off takes as long as any."""
    size: Any = len(payload)
    if size < 126:
        head = bytes([0x80 | size])
    elif size < 1 << 16:
        head = b"\xfe" + size.to_bytes(2)
    else:
        head = b"\xff" + size.to_bytes(8)
    return kind + head + bytes(4) + payload
