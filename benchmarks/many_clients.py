# SPDX-License-Identifier: Apache-2.0
"""A process with many WebSocket clients of one topic, which only counts what all of them get.

``URL SAMPLE COUNT`` as arguments; on SIGUSR1 it prints the count so far.
"""

import asyncio
import json
import signal
import sys
from typing import Final

from websockets.asyncio.client import connect

from benchmarks.samples import topic

_HANDSHAKES: Final = 8  # at once: a gateway cuts off a crowd at its door


class _Counter:
    frames = 0


async def main(url: str, name: str, clients: int) -> None:
    """Receive until SIGINT."""
    counter = _Counter()
    receiving = asyncio.current_task()
    assert receiving is not None
    loop = asyncio.get_running_loop()
    loop.add_signal_handler(signal.SIGINT, receiving.cancel)
    loop.add_signal_handler(signal.SIGUSR1, lambda: print("count", counter.frames, flush=True))
    subscribed = asyncio.Semaphore(0)
    handshakes = asyncio.Semaphore(_HANDSHAKES)

    async def receive() -> None:
        async with handshakes:
            socket = await connect(url, compression=None, max_size=None, proxy=None)
        async with socket:
            await socket.send(json.dumps({"op": "subscribe", "topic": topic(name)}))
            await socket.recv(decode=False)
            subscribed.release()
            while True:
                await socket.recv(decode=False)
                counter.frames += 1

    try:
        async with asyncio.TaskGroup() as group:
            for _ in range(clients):
                group.create_task(receive())
            for _ in range(clients):
                await subscribed.acquire()
            print("ready", flush=True)
    except* asyncio.CancelledError:
        pass


if __name__ == "__main__":
    asyncio.run(main(sys.argv[1], sys.argv[2], int(sys.argv[3])))
