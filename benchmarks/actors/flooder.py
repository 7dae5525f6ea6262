# SPDX-License-Identifier: Apache-2.0
"""Clients that send one kind of operations, as fast as they may: ``URL KIND CLIENTS`` as arguments.

They end with stdin.
"""

import contextlib
import itertools
import sys
import threading
from collections.abc import Callable, Iterable
from typing import Final

from benchmarks.actors.connection import RawConnection
from benchmarks.actors.orders import reply


def _publish(topic: str, type_name: str, message: str) -> bytes:
    text = f'{{"op":"publish","topic":"/{topic}","type":"{type_name}","msg":{message}}}'
    return text.encode()


def _subscriptions() -> list[bytes]:
    return [
        b'{"op":"%s","topic":"/flood_%d","type":"std_msgs/String"}' % (op, number)
        for number in range(50)
        for op in (b"subscribe", b"unsubscribe")
    ]


_FLOODS: Final[dict[str, Callable[[], list[bytes]]]] = {
    "floats": lambda: [
        _publish(
            "floats", "std_msgs/Float64MultiArray", f'{{"data":[{",".join(["1.25"] * 50_000)}]}}'
        )
    ],
    "elements": lambda: [
        _publish("poses", "geometry_msgs/PoseArray", f'{{"poses":[{",".join(["{}"] * 9000)}]}}')
    ],
    "subscriptions": _subscriptions,
    "rosapi": lambda: [
        b'{"op":"call_service","service":"/rosapi/%s"}' % name
        for name in (b"topics", b"nodes", b"services", b"topics_and_raw_types")
    ],
    "returning": _subscriptions,
}
KINDS: Final = tuple(_FLOODS)


def main(url: str, kind: str, clients: str) -> None:
    """Flood until the end of stdin."""
    operations = _FLOODS[kind]()
    is_over = threading.Event()
    flood = _return if kind == "returning" else _flood

    def run() -> None:
        while not is_over.is_set():
            with contextlib.suppress(OSError):
                flood(url, operations, is_over)

    for _ in range(int(clients)):
        threading.Thread(target=run, daemon=True).start()
    reply("ready")
    sys.stdin.read()
    is_over.set()


def _flood(url: str, operations: list[bytes], is_over: threading.Event) -> None:
    with RawConnection(url) as connection:
        connection.answer_pings()
        _send(connection, itertools.cycle(operations), is_over)


def _return(url: str, operations: list[bytes], is_over: threading.Event) -> None:
    """Connect, open something, and go."""
    with RawConnection(url) as connection:
        _send(connection, operations[:4], is_over)


def _send(connection: RawConnection, operations: Iterable[bytes], is_over: threading.Event) -> None:
    for operation in operations:
        if is_over.is_set():
            return
        connection.send_text(operation)


if __name__ == "__main__":
    main(*sys.argv[1:])
