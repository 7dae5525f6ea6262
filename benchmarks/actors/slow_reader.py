# SPDX-License-Identifier: Apache-2.0
"""A client that subscribes and then reads slowly: ``URL BYTES_PER_S SAMPLE ...`` as arguments.

At 0 bytes per second it reads nothing. The order ``is_connected`` is for one that reads.
"""

import sys
import threading
import time
from typing import Final

from benchmarks.actors.connection import RawConnection
from benchmarks.actors.orders import obey, reply
from benchmarks.samples import message_type, topic

_READ_BYTES: Final = 4 * 1024
_BUFFER_BYTES: Final = 8 * 1024


def main(url: str, bytes_per_s: str, *names: str) -> None:
    """Keep the connection open until the end of stdin."""
    over = threading.Event()
    with RawConnection(url, _READ_BYTES, receive_buffer_bytes=_BUFFER_BYTES) as connection:
        reader = threading.Thread(target=_read, args=(connection, float(bytes_per_s)), daemon=True)
        obey({"is_connected": reader.is_alive}, over.set)
        for name in names:
            connection.send({"op": "subscribe", "topic": topic(name), "type": message_type(name)})
        if float(bytes_per_s):
            reader.start()
        reply("ready")
        over.wait()


def _read(connection: RawConnection, bytes_per_s: float) -> None:
    taken, start_s = 0, time.monotonic()
    try:
        while True:
            taken += sum(map(len, connection.receive()))
            time.sleep(max(0.0, start_s + taken / bytes_per_s - time.monotonic()))
    except OSError as error:
        print(f"slow_reader: {error}", file=sys.stderr)


if __name__ == "__main__":
    main(*sys.argv[1:])
