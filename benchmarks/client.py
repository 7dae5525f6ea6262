# SPDX-License-Identifier: Apache-2.0
"""A WebSocket client in a process of its own that notes how old each message is."""

import asyncio
import json
import re
import signal
import sys
import time

from websockets.asyncio.client import connect

from benchmarks.report import Ages

# a full parse would make the client, not the gateway, what is measured on two cores
_STAMP = re.compile(rb'"stamp":\{"sec":(\d+),"nanosec":(\d+)\}')


async def main(url: str, topic: str) -> None:
    """Receive until SIGINT, then print the ages."""
    ages = Ages()
    receiving = asyncio.current_task()
    assert receiving is not None
    asyncio.get_running_loop().add_signal_handler(signal.SIGINT, receiving.cancel)
    async with connect(url, compression=None, max_size=None, proxy=None) as socket:
        await socket.send(json.dumps({"op": "subscribe", "topic": topic}))
        ages.announce()
        try:
            while True:
                frame = await socket.recv(decode=False)
                now_ns = time.time_ns()
                found = _STAMP.search(frame)
                if found is None:  # a word about a topic that is still being discovered
                    continue
                ages.add(now_ns - int(found[1]) * 1_000_000_000 - int(found[2]))
        except asyncio.CancelledError:
            ages.print()


if __name__ == "__main__":
    asyncio.run(main(sys.argv[1], sys.argv[2]))
