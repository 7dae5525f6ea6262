# SPDX-License-Identifier: Apache-2.0
"""A client that means harm: it floods, sends garbage, and frames that cost much.

``HOST PORT REST_S`` as arguments. It rests for so long after each second of harm.

It has a separate address (127.0.0.66), because the clients of an address share
its limits. It never publishes on a command topic: the robot is moved by the operator alone.
Orders: ``count``.
"""

import contextlib
import itertools
import json
import random
import socket
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Final

from websockets.client import ClientProtocol
from websockets.uri import parse_uri

from benchmarks.actors.frames import BINARY, PING, TEXT, client_frame
from benchmarks.actors.orders import obey, reply
from benchmarks.hostile_frames import plain_frames
from tests.soak.load import TOPICS, subscribe

_ADDRESS: Final = "127.0.0.66"
_BOUT_S: Final = 1.0
_TIMEOUT_S: Final = 3.0
_FRAMES: Final = 3  # at a time, but the first time all
_LARGEST_FRAME: Final = 1024**2
_HALF_OPEN: Final = 24  # more than the gateway lets wait
_MANY: Final = 100  # topics, more than a client may have


class Abuser:
    """The actions of the abuser, one at a time."""

    def __init__(self, host: str, port: int) -> None:
        self._target = host, port
        self._chance = random.Random(2)
        self._frames = [one.data for one in plain_frames() if len(one.data) <= _LARGEST_FRAME]
        self._next_frames = itertools.cycle(self._frames)
        self.bouts = 0

    @property
    def kinds(self) -> int:
        """The number of things that it can do."""
        return len(self._acts())

    def bout(self) -> None:
        """Do one of the things that it can do."""
        acts = self._acts()
        with contextlib.suppress(OSError):
            acts[self.bouts % len(acts)]()
        self.bouts += 1

    def _acts(self) -> Sequence[Callable[[], None]]:
        return (
            self._garbage_instead_of_http,
            self._half_open,
            self._garbage_instead_of_frames,
            self._garbage_in_frames,
            self._flood_of_pings,
            self._flood_of_publishes,
            self._hostile_frames,
            self._never_read,
            self._open_much,
        )

    def _connect(self) -> socket.socket:
        connection = socket.create_connection(
            self._target, timeout=_TIMEOUT_S, source_address=(_ADDRESS, 0)
        )
        connection.settimeout(_TIMEOUT_S)
        return connection

    @contextlib.contextmanager
    def _open(self) -> Iterator[socket.socket]:
        host, port = self._target
        protocol = ClientProtocol(parse_uri(f"ws://{host}:{port}/"))
        with self._connect() as connection:
            protocol.send_request(protocol.connect())
            for chunk in protocol.data_to_send():
                connection.sendall(chunk)
            head = b""
            while not head.endswith(b"\r\n\r\n"):
                byte = connection.recv(1)
                if not byte:
                    raise ConnectionError("refused")
                head += byte
            yield connection

    def _garbage_instead_of_http(self) -> None:
        for _ in range(20):
            with self._connect() as connection:
                connection.sendall(self._chance.randbytes(500))

    def _half_open(self) -> None:
        with contextlib.ExitStack() as stack:
            for _ in range(_HALF_OPEN):
                connection = stack.enter_context(self._connect())
                connection.sendall(b"GET / HTTP/1.1\r\nHost: ")
            time.sleep(_BOUT_S)

    def _garbage_instead_of_frames(self) -> None:
        for _ in range(10):
            with self._open() as connection:
                connection.sendall(self._chance.randbytes(2000))

    def _garbage_in_frames(self) -> None:
        with self._open() as connection:
            text = json.dumps(subscribe(TOPICS[0], meta=True)).encode()
            for _ in range(200):
                broken = bytearray(text)
                for _ in range(self._chance.randint(1, 4)):
                    broken[self._chance.randrange(len(broken))] = self._chance.randrange(32, 127)
                connection.sendall(client_frame(TEXT, bytes(broken)))

    def _flood(self, frame: bytes) -> None:
        end_s = time.monotonic() + _BOUT_S
        with self._open() as connection:
            while time.monotonic() < end_s:
                connection.sendall(frame * 100)

    def _flood_of_pings(self) -> None:
        self._flood(client_frame(PING, b"x" * 125))

    def _flood_of_publishes(self) -> None:
        operation = {
            "op": "publish",
            "topic": "/soak/flood",
            "type": "std_msgs/String",
            "msg": {"data": "x"},
        }
        self._flood(client_frame(TEXT, json.dumps(operation).encode()))

    def _hostile_frames(self) -> None:
        is_first = self.bouts < self.kinds
        for frame in itertools.islice(
            self._next_frames, len(self._frames) if is_first else _FRAMES
        ):
            with contextlib.suppress(OSError), self._open() as connection:
                connection.sendall(client_frame(BINARY, frame))
                connection.sendall(client_frame(TEXT, b'{"op":"ping","id":"done"}'))
                seen = b""
                while b'"done"' not in seen:
                    received = connection.recv(65536)
                    if not received:
                        break
                    seen = seen[-100:] + received

    def _never_read(self) -> None:
        with self._open() as connection:
            for topic in TOPICS:
                connection.sendall(client_frame(TEXT, json.dumps(subscribe(topic)).encode()))
            time.sleep(_BOUT_S)

    def _open_much(self) -> None:
        with self._open() as connection:
            for number in range(_MANY):
                for op in ("subscribe", "advertise"):
                    operation = {
                        "op": op,
                        "topic": f"/soak/much_{number}",
                        "type": "std_msgs/String",
                    }
                    connection.sendall(client_frame(TEXT, json.dumps(operation).encode()))
            time.sleep(_BOUT_S)


def main(host: str, port: int, rest_s: float) -> None:
    """Do harm until the end of stdin."""
    over = threading.Event()
    abuser = Abuser(host, port)
    obey({"count": lambda: abuser.bouts, "kinds": lambda: abuser.kinds}, over.set)
    reply("ready")
    while not over.wait(rest_s):
        abuser.bout()


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), float(sys.argv[3]))
