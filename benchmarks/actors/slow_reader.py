# SPDX-License-Identifier: Apache-2.0
"""A client that subscribes and then reads nothing: ``URL SAMPLE ...`` as arguments."""

import sys
import threading

from benchmarks.actors.connection import RawConnection
from benchmarks.actors.orders import obey, reply
from benchmarks.samples import message_type, topic


def main(url: str, *names: str) -> None:
    """Keep the connection open until the end of stdin."""
    over = threading.Event()
    obey({}, over.set)
    with RawConnection(url) as connection:
        for name in names:
            connection.send({"op": "subscribe", "topic": topic(name), "type": message_type(name)})
        reply("ready")
        over.wait()


if __name__ == "__main__":
    main(*sys.argv[1:])
