# SPDX-License-Identifier: Apache-2.0
"""Clients that come late to a latched topic: ``URL GIANT`` as arguments.

``join`` connects, subscribes, waits for the giant, leaves, and answers with the time that it took
and the size of the frame. ``stay`` does so and keeps the connection, which goes on reading.
"""

import contextlib
import sys
import threading
import time

from benchmarks.actors.connection import RawConnection
from benchmarks.actors.orders import obey, reply
from benchmarks.giants import GIANTS, topic

_ROOM = 128 << 20  # of one frame, with a buffer that need not grow
_LEAST = 1 << 20  # bytes. Anything shorter is a status


def main(url: str, name: str) -> None:
    """Come and go as ordered until the end of stdin."""
    over = threading.Event()
    with contextlib.ExitStack() as stack:

        def stay() -> dict[str, float]:
            connection = stack.enter_context(RawConnection(url, _ROOM))
            answer = _wait(connection, name)
            connection.answer_pings()
            return answer

        obey({"join": lambda: _join(url, name), "stay": stay}, over.set)
        reply("ready")
        over.wait()


def _join(url: str, name: str) -> dict[str, float]:
    with RawConnection(url, _ROOM) as connection:
        return _wait(connection, name)


def _wait(connection: RawConnection, name: str) -> dict[str, float]:
    giant = GIANTS[name]
    begun_s = time.monotonic()
    connection.send({"op": "subscribe", "topic": topic(name), "type": giant.type, **giant.options})
    while True:
        for payload in connection.receive():
            if len(payload) > _LEAST:
                return {"ms": (time.monotonic() - begun_s) * 1e3, "mb": len(payload) / 1e6}


if __name__ == "__main__":
    main(*sys.argv[1:])
