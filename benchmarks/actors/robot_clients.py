# SPDX-License-Identifier: Apache-2.0
"""A process with WebSocket clients of all topics of the robot.

``URL OPTIONS CLIENTS`` as arguments. OPTIONS are some of `PICTURE_OPTIONS`. Orders: ``complete``
answers with the number of clients that have got each topic, ``count`` with the messages by topic,
``report`` with the ages by topic, ``clear`` forgets both.
"""

import re
import selectors
import sys
import time
from collections import Counter
from typing import Final

from benchmarks.actors.connection import RawConnection
from benchmarks.actors.orders import obey, reply
from benchmarks.actors.report import Ages
from benchmarks.robot import AGED, CAMERAS, PICTURE_OPTIONS, ROBOT, clockwork
from benchmarks.samples import topic

_HEAD: Final = 160  # bytes of a frame that contain its topic
_LOOK_S: Final = 0.2  # the delay at the end
_NAMES: Final = {topic(name).encode(): name for name in ROBOT}
_LONGEST_FIRST: Final = sorted(_NAMES, key=len, reverse=True)  # as some begin with another
# in JSON with any white space, and in CBOR
_TOPIC: Final = re.compile(
    rb".{0,12}publish.{0,4}topic.{0,4}?(%s)" % b"|".join(_LONGEST_FIRST), re.DOTALL
)


class RobotMessages:
    """The messages that all clients of a process have got."""

    def __init__(self, options: str) -> None:
        self._ages = {name: Ages() for name in AGED}
        self._clockworks = {name: clockwork(options, name) for name in AGED}
        self._counts: Counter[str] = Counter()
        self._got: dict[int, set[str]] = {}
        self.is_over = False

    def note(self, client: int, payload: bytes | memoryview, now_ns: int) -> None:
        """Record a frame, unless it is something else than a message, such as a status."""
        head = _TOPIC.match(payload[:_HEAD])
        if head is None:
            return
        name = _NAMES[head[1]]
        self._counts[name] += 1
        self._got.setdefault(client, set()).add(name)
        if name in self._ages and (found := self._clockworks[name].pattern.search(payload)):
            self._ages[name].add(self._clockworks[name].parse(found), now_ns)

    def complete(self) -> int:
        """Return the number of clients that have got each topic."""
        return sum(len(names) == len(ROBOT) for names in list(self._got.values()))

    def count(self) -> dict[str, int]:
        """Return the number of messages by topic."""
        return {name: self._counts[name] for name in ROBOT}

    def report(self) -> dict[str, object]:
        """Return the ages by topic."""
        return {name: one.summary() for name, one in self._ages.items()}

    def clear(self) -> bool:
        """Forget the messages so far. Call it while none arrive."""
        self._counts.clear()
        return all(one.clear() for one in self._ages.values())

    def end(self) -> None:
        """Have the process end."""
        self.is_over = True


def main(url: str, options: str, clients: int) -> None:
    """Receive until the end of stdin."""
    messages = RobotMessages(options)
    orders = ("complete", "count", "report", "clear")
    obey({name: getattr(messages, name) for name in orders}, messages.end)
    selector = selectors.DefaultSelector()
    for _ in range(clients):
        connection = RawConnection(url)
        selector.register(connection, selectors.EVENT_READ, connection)
        for name, one in ROBOT.items():
            of_pictures = PICTURE_OPTIONS[options] if name in CAMERAS else {}
            subscription = {"op": "subscribe", "topic": topic(name), "type": one.type_name()}
            connection.send(subscription | of_pictures)
    reply("ready")
    while not messages.is_over:
        for key, _ in selector.select(_LOOK_S):
            for payload in key.data.receive():
                messages.note(key.fd, payload, time.time_ns())


if __name__ == "__main__":
    try:
        main(sys.argv[1], sys.argv[2], int(sys.argv[3]))
    except ConnectionError as error:
        sys.exit(f"robot_clients: {error}")
