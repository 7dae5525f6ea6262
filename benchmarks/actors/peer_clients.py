# SPDX-License-Identifier: Apache-2.0
"""A process with many clients of a topic, of rosbridge's protocol or of Foxglove's.

``URL SAMPLE FORM CLIENTS`` as arguments. FORM is the ``compression`` of rosbridge, or ``foxglove``.
Up to ten clients record ages. The kernel discards what the others get, so that clients leave the
processor to the server. Orders: ``served`` answers with the number of clients that have got a
frame, ``count`` with the frames of all, ``clear`` forgets ages, and ``report`` answers with them.
"""

import json
import re
import selectors
import struct
import sys
import time
from typing import Final

from websockets.typing import Subprotocol

from benchmarks.actors.connection import RawConnection
from benchmarks.actors.orders import obey, reply
from benchmarks.actors.report import Ages
from benchmarks.samples import HEADER, RAW_HEADER, Clockwork, message_type, topic

FOXGLOVE: Final = "foxglove"

_PROTOCOL: Final = Subprotocol("foxglove.sdk.v1")
_SUBSCRIPTION: Final = 1
_AGED: Final = 10  # clients
_LOOK_S: Final = 0.2  # the delay at the end
_FRAME_HEADER: Final = 10  # bytes before the payload of a long frame (RFC 6455, section 5.2)
# opcode 1, the subscription, the time of the server, and CDR
_FOXGLOVE_HEADER: Final = re.compile(rb"\x01.{12}\0\x01..(.{8})", re.DOTALL)


class PeerMessages:
    """The messages that all clients have got."""

    def __init__(self, form: str) -> None:
        self.is_over = False
        self._clockwork = _clockwork(form)
        self._ages = Ages()
        self._frames = 0
        self._frame_bytes = 0
        self._discarded: dict[int, int] = {}  # bytes, by client
        self._aged: set[int] = set()

    def note(self, client: int, payload: memoryview, now_ns: int) -> None:
        """Record a frame, unless it is something else than a message."""
        found = self._clockwork.pattern.search(payload)
        if found is None:
            return
        self._ages.add(self._clockwork.parse(found), now_ns)
        self._frames += 1
        self._frame_bytes = len(payload)
        self._aged.add(client)

    def note_discarded(self, client: int, size: int) -> None:
        """Count bytes that nobody has looked at."""
        self._discarded[client] = self._discarded.get(client, 0) + size

    def served(self) -> int:
        """Return the number of clients that have got a frame."""
        discarded = list(self._discarded.values())
        whole = sum(size > self._frame_bytes for size in discarded) if self._frames else 0
        return len(self._aged) + whole

    def count(self) -> float:
        """Return the frames of all clients. All frames are as long as the last one."""
        if not self._frames:
            return 0
        header = 4 if self._frame_bytes < 1 << 16 else _FRAME_HEADER
        discarded = sum(list(self._discarded.values()))
        return self._frames + discarded / (self._frame_bytes + header)

    def clear(self) -> bool:
        """Forget ages, not counts."""
        self._ages = Ages()
        return True

    def report(self) -> object:
        """Return the summary of the ages."""
        return self._ages.summary()

    def end(self) -> None:
        """Have the process end."""
        self.is_over = True


def main(url: str, name: str, form: str, clients: int) -> None:
    """Receive until the end of stdin."""
    messages = PeerMessages(form)
    orders = ("served", "count", "report", "clear")
    obey({order: getattr(messages, order) for order in orders}, messages.end)
    selector = selectors.DefaultSelector()
    each = max(1, clients // _AGED)
    for number in range(clients):
        connection = _subscribed(url, name, form)
        selector.register(connection, selectors.EVENT_READ, (connection, number % each == 0))
    reply("ready")
    while not messages.is_over:
        for key, _ in selector.select(_LOOK_S):
            connection, is_aged = key.data
            if is_aged:
                for payload in connection.receive():
                    messages.note(key.fd, payload, time.time_ns())
            else:
                messages.note_discarded(key.fd, connection.discard())


def _subscribed(url: str, name: str, form: str) -> RawConnection:
    if form != FOXGLOVE:
        connection = RawConnection(url)
        connection.send(
            {
                "op": "subscribe",
                "topic": topic(name),
                "type": message_type(name),
                "compression": form,
            }
        )
        return connection
    connection = RawConnection(url, subprotocols=[_PROTOCOL])
    channel = _channel(connection, name)
    subscription = {"id": _SUBSCRIPTION, "channelId": channel}
    connection.send({"op": "subscribe", "subscriptions": [subscription]})
    return connection


def _channel(connection: RawConnection, name: str) -> int:
    """Wait until the server advertises the topic, and return the id."""
    while True:
        for payload in connection.receive():
            frame = json.loads(bytes(payload))
            for one in frame.get("channels", ()):
                if one["topic"] == topic(name):
                    return int(one["id"])


def _clockwork(form: str) -> Clockwork:
    if form == FOXGLOVE:
        return Clockwork(
            HEADER.write,
            HEADER.read,
            _FOXGLOVE_HEADER,
            lambda found: _nanoseconds(*struct.unpack("<iI", found[1])),
        )
    return RAW_HEADER if form == "cbor-raw" else HEADER


def _nanoseconds(sec: int, nanosec: int) -> int:
    return sec * 1_000_000_000 + nanosec


if __name__ == "__main__":
    try:
        main(sys.argv[1], sys.argv[2], sys.argv[3], int(sys.argv[4]))
    except ConnectionError as error:
        sys.exit(f"peer_clients: {error}")
