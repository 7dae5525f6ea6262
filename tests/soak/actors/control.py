# SPDX-License-Identifier: Apache-2.0
"""The control of times: a process that sleeps and looks how long it has slept, and an echo.

Anything late here is late because of the machine. Orders: ``late``, which answers with the pauses
that were too long since the last time, and ``port`` with that of the echo.
"""

import asyncio
import contextlib
import os
import threading
import time
from typing import Final

from benchmarks.actors.orders import obey, reply

_PAUSE_S: Final = 0.01
_LATE_S: Final = 0.005  # shorter pauses concern no limit


async def main() -> None:
    """Sleep and echo until the end of stdin."""
    loop = asyncio.get_running_loop()
    over = asyncio.Event()
    late: list[tuple[float, float]] = []

    def sleep() -> None:
        while True:
            begun_s = time.monotonic()
            time.sleep(_PAUSE_S)
            now_s = time.monotonic()
            if now_s - begun_s > _PAUSE_S + _LATE_S:
                late.append((now_s, now_s - begun_s - _PAUSE_S))

    def take_late() -> list[tuple[float, float]]:
        taken = late[:]
        del late[: len(taken)]
        return taken

    async def echo(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        with contextlib.suppress(OSError):
            while line := await reader.readline():
                writer.write(line)
        writer.close()

    server = await asyncio.start_server(echo, "127.0.0.1", 0)
    port = server.sockets[0].getsockname()[1]
    threading.Thread(target=sleep, daemon=True).start()
    obey(
        {"late": take_late, "port": lambda: port},
        lambda: loop.call_soon_threadsafe(over.set),
    )
    reply("ready")
    await over.wait()
    os._exit(0)  # connections of the echo are of no interest any more


if __name__ == "__main__":
    asyncio.run(main())
