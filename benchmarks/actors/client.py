# SPDX-License-Identifier: Apache-2.0
"""A WebSocket client in a separate process that records the age of each message.

``URL SAMPLE ...`` as arguments. Orders: ``count`` (of all), ``report`` (by sample), ``clear``.
"""

import sys
import time

from benchmarks.actors.connection import RawConnection
from benchmarks.actors.orders import obey, reply
from benchmarks.actors.report import Ages
from benchmarks.samples import SAMPLES, message_type, topic

_HEAD = 160  # bytes of a frame that contain its topic


def main(url: str, *names: str) -> None:
    """Receive until the end of stdin."""
    ages = {name: Ages() for name in names}
    with RawConnection(url) as connection:
        obey(
            {
                "count": lambda: sum(map(len, ages.values())),
                "report": lambda: {name: one.summary() for name, one in ages.items()},
                "clear": lambda: all(one.clear() for one in ages.values()),
            },
            connection.stop,
        )
        for name in names:
            connection.send(
                {
                    "op": "subscribe",
                    "topic": topic(name),
                    "type": message_type(name),
                    "compression": SAMPLES[name].compression,
                }
            )
        reply("ready")
        try:
            while True:
                for payload in connection.receive():
                    _note(payload, ages)
        except ConnectionError as error:
            if not connection.is_over:
                sys.exit(str(error))


def _note(payload: memoryview, ages: dict[str, Ages]) -> None:
    now_ns = time.time_ns()
    name = next(iter(ages)) if len(ages) == 1 else _name(bytes(payload[:_HEAD]), ages)
    clockwork = SAMPLES[name].clockwork
    found = clockwork.pattern.search(payload)
    if found is not None:  # otherwise a status about a topic that is still being discovered
        ages[name].add(clockwork.parse(found), now_ns)


def _name(head: bytes, names: dict[str, Ages]) -> str:
    return next(name for name in names if b'"%s"' % topic(name).encode() in head)


if __name__ == "__main__":
    main(*sys.argv[1:])
