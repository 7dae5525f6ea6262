# SPDX-License-Identifier: Apache-2.0
"""A WebSocket client in a process of its own that notes how old each message is."""

import asyncio
import json
import signal
import sys
import time

from websockets.asyncio.client import connect

from benchmarks.report import Ages
from benchmarks.samples import SAMPLES, topic


async def main(url: str, name: str) -> None:
    """Receive until SIGINT, then print the ages."""
    ages = Ages()
    clockwork = SAMPLES[name].clockwork
    receiving = asyncio.current_task()
    assert receiving is not None
    asyncio.get_running_loop().add_signal_handler(signal.SIGINT, receiving.cancel)
    async with connect(url, compression=None, max_size=None, proxy=None) as socket:
        await socket.send(json.dumps({"op": "subscribe", "topic": topic(name)}))
        ages.announce()
        try:
            while True:
                frame = await socket.recv(decode=False)
                now_ns = time.time_ns()
                found = clockwork.pattern.search(frame)
                if found is None:  # a word about a topic that is still being discovered
                    continue
                ages.add(now_ns - clockwork.parse(found))
        except asyncio.CancelledError:
            ages.print()


if __name__ == "__main__":
    asyncio.run(main(sys.argv[1], sys.argv[2]))
