# SPDX-License-Identifier: Apache-2.0
"""A process with many WebSocket clients, which only counts the frames of all of them.

``URL SAMPLE CLIENTS TOPICS`` as arguments: each client subscribes to all topics of the sample.
It is ready when all are subscribed. Orders: ``count``, and ``clients`` that have got a frame.
"""

import selectors
import sys
from typing import Final

from benchmarks.actors.connection import RawConnection
from benchmarks.actors.orders import obey, reply
from benchmarks.samples import message_type, topic

_ROOM: Final = 1 << 16  # bytes for each client: a few dozen frames
_LOOK_S: Final = 0.2  # the delay at the end


class _Crowd:
    def __init__(self) -> None:
        self.frames = 0
        self.served: set[int] = set()
        self.is_over = False

    def end(self) -> None:
        self.is_over = True


def main(url: str, name: str, clients: int, topics: int) -> None:
    """Receive until the end of stdin."""
    crowd = _Crowd()
    obey({"count": lambda: crowd.frames, "clients": lambda: len(crowd.served)}, crowd.end)
    selector = selectors.DefaultSelector()
    for _ in range(clients):  # one after the other: a server may bound its handshakes
        connection = RawConnection(url, _ROOM)
        selector.register(connection, selectors.EVENT_READ, connection)
        for number in range(topics):
            connection.send(
                {"op": "subscribe", "topic": topic(name, number), "type": message_type(name)}
            )
    reply("ready")
    while not crowd.is_over:
        for key, _ in selector.select(_LOOK_S):
            connection = key.data
            frames = sum(1 for _ in connection.receive())
            if frames:
                crowd.frames += frames
                crowd.served.add(key.fd)


if __name__ == "__main__":
    try:
        main(sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4]))
    except ConnectionError as error:
        sys.exit(f"crowd: {error}")
