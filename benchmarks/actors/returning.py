# SPDX-License-Identifier: Apache-2.0
"""A client that connects until it succeeds, and then waits for a first sample: ``URL SAMPLE``.

``begin`` as an order. The answer has the times at which it was connected and had the sample, and
the sample's age.
"""

import sys
import threading
import time
from typing import Any, Final

from benchmarks.actors.connection import RawConnection
from benchmarks.actors.orders import obey, reply
from benchmarks.samples import SAMPLES, message_type, topic

_ATTEMPT_S: Final = 0.2  # shorter than the kernel's first repetition of a SYN, which takes a second


def main(url: str, name: str) -> None:
    """Obey until the end of stdin."""
    over = threading.Event()
    begun = threading.Event()

    def end() -> None:
        over.set()
        begun.set()

    obey({"begin": begun.set}, end)
    reply("ready")
    begun.wait()
    if not over.is_set():
        reply(_return(url, name, over))
    over.wait()


def _return(url: str, name: str, over: threading.Event) -> dict[str, Any]:
    while not over.is_set():
        try:
            with RawConnection(url, handshake_s=_ATTEMPT_S) as connection:
                connected_ns = time.time_ns()
                return {"connected_ns": connected_ns, **_first(connection, name)}
        except OSError:
            time.sleep(0.02)  # there may be no route at all
    return {}


def _first(connection: RawConnection, name: str) -> dict[str, Any]:
    """Subscribe, and return when the first sample came that was made since then."""
    subscribed_ns = time.time_ns()
    connection.send({"op": "subscribe", "topic": topic(name), "type": message_type(name)})
    clockwork = SAMPLES[name].clockwork
    while True:
        for payload in connection.receive():
            found = clockwork.pattern.search(payload)
            if found is not None and (stamp_ns := clockwork.parse(found)) > subscribed_ns:
                now_ns = time.time_ns()
                return {"first_ns": now_ns, "age_ms": (now_ns - stamp_ns) / 1e6}


if __name__ == "__main__":
    main(*sys.argv[1:])
