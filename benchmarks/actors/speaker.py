# SPDX-License-Identifier: Apache-2.0
"""A WebSocket client that publishes stamped Twists: ``URL PART/PARTS`` as arguments.

Orders: as those of the publisher.
"""

import sys
import time

from benchmarks.actors.connection import RawConnection
from benchmarks.actors.pace import Stamps
from benchmarks.actors.runs import do_runs
from benchmarks.samples import message_type, topic

_TEXT = (
    b'{"op":"publish","topic":"%s","msg":{"linear":{"x":%d,"y":0.0,"z":0.0},'
    b'"angular":{"x":0.0,"y":0.0,"z":1.82}}}'
)


def main(url: str, share: str) -> None:
    """Publish as ordered until the end of stdin."""
    part, parts = map(int, share.split("/"))
    stamps = Stamps(part, parts)
    destination = topic("twist").encode()
    with RawConnection(url) as connection:
        connection.send({"op": "advertise", "topic": topic("twist"), "type": message_type("twist")})
        connection.answer_pings()

        def send() -> None:
            stamp_us = stamps.next(time.time_ns()) // 1000
            connection.send_text(_TEXT % (destination, stamp_us))

        do_runs(send)


if __name__ == "__main__":
    try:
        main(sys.argv[1], sys.argv[2])
    except ConnectionError as error:
        sys.exit(f"speaker: {error}")
