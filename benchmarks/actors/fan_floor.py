# SPDX-License-Identifier: Apache-2.0
"""A WebSocket server that only writes: the floor for any server in Python.

It shakes hands with the library's sans-I/O protocol under uvloop, ignores all input, and writes
one prepared frame to every client, ``BYTES RATE_HZ`` as arguments.
"""

import asyncio
import sys

import uvloop

from benchmarks.actors.audience import Audience
from benchmarks.actors.orders import obey, reply


async def main(size: int, rate_hz: float) -> None:
    """Serve until the end of stdin."""
    loop = asyncio.get_running_loop()
    over = asyncio.Event()
    audience = Audience()
    obey({}, lambda: loop.call_soon_threadsafe(over.set))
    reply(await audience.listen())
    frame = b"\x81\x7e" + size.to_bytes(2, "big") + b'{"op":"publish"}'.ljust(size)
    due_s = loop.time()
    while not over.is_set():
        due_s += 1 / rate_hz
        await asyncio.sleep(due_s - loop.time())
        audience.write(frame)


if __name__ == "__main__":
    uvloop.run(main(int(sys.argv[1]), float(sys.argv[2])))
