# SPDX-License-Identifier: Apache-2.0
"""A WebSocket client that records bursts of a sample: ``URL SAMPLE`` as arguments.

Its subscription has the default options. ``meta`` alone is set, as it reports what was lost.
Orders: ``count``, ``clear``, and ``burst``, which answers with the messages since. See
`Burst.summary`.
"""

import re
import sys
import time
from typing import Any, Final

from benchmarks.actors.connection import RawConnection
from benchmarks.actors.orders import obey, reply
from benchmarks.actors.report import Ages
from benchmarks.samples import SAMPLES, Clockwork, message_type, topic

_HEAD: Final = 240  # bytes of a frame that contain the members of ``meta``
_DROPPED: Final = re.compile(rb'"dropped": ?(\d+)')


class Burst:
    """The messages of a sample since the last `clear`."""

    def __init__(self, clockwork: Clockwork) -> None:
        self._clockwork = clockwork
        self._ages = Ages()
        self._dropped: int | None = None  # since the subscription, by the last frame
        self._dropped_before = 0

    def note(self, payload: bytes | memoryview, now_ns: int) -> None:
        """Record a frame, unless it is something else than a message, such as a status."""
        found = self._clockwork.pattern.search(payload)
        if found is None:
            return
        if dropped := _DROPPED.search(payload[:_HEAD]):
            self._dropped = int(dropped[1])
        self._ages.add(self._clockwork.parse(found), now_ns)

    def count(self) -> int:
        """Return the number of messages."""
        return len(self._ages)

    def clear(self) -> bool:
        """Forget the messages so far. Call it while none arrive."""
        self._dropped_before = self._dropped or 0
        return self._ages.clear()

    def summary(self) -> dict[str, Any]:
        """Return the distinct messages, and the time from the first sending to the last arrival.

        ``reported`` is the number that the server reports as lost, ``None`` if it reports nothing.
        """
        summary = self._ages.summary()
        reported = None if self._dropped is None else self._dropped - self._dropped_before
        return {
            "distinct": summary["distinct"],
            "reported": reported,
            "took_ms": summary.get("took_ms"),
        }


def main(url: str, name: str) -> None:
    """Receive until the end of stdin."""
    burst = Burst(SAMPLES[name].clockwork)
    with RawConnection(url) as connection:
        orders = {"count": burst.count, "clear": burst.clear, "burst": burst.summary}
        obey(orders, connection.stop)
        subscription = {"op": "subscribe", "topic": topic(name), "type": message_type(name)}
        connection.send(subscription | {"meta": True})
        reply("ready")
        try:
            while True:
                for payload in connection.receive():
                    burst.note(payload, time.time_ns())
        except ConnectionError as error:
            if not connection.is_over:
                sys.exit(str(error))


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
