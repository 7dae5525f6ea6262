# SPDX-License-Identifier: Apache-2.0
"""A client that connects, subscribes to something and leaves, over and over: ``URL``.

It leaves politely or by cutting its connection, at once or after a second. Orders: ``count``.
"""

import asyncio
import contextlib
import json
import random
import sys
from collections.abc import Iterator
from typing import Any, Final

from websockets.asyncio.client import connect
from websockets.exceptions import WebSocketException

from benchmarks.actors.orders import obey, reply
from tests.soak.load import CAMERA, ODOMETRY, SCAN, TOPICS, subscribe

_REST_S: Final = 0.1
_LONGEST_S: Final = 1.0


def operations(number: int, chance: random.Random) -> Iterator[dict[str, Any]]:
    """Return what it opens: some of the load, in changing encodings, and other operations."""
    for topic in chance.sample(TOPICS, chance.randint(1, len(TOPICS))):
        yield subscribe(topic, meta=chance.random() < 0.5)
    encoding = chance.choice(["cbor", "cbor-raw", "png"])
    yield {**subscribe(SCAN), "id": "b", "compression": encoding}
    yield {**subscribe(ODOMETRY), "id": "b", "throttle_rate": chance.randint(50, 500)}
    width = chance.choice([160, 320])  # each is a separate encoding
    yield {**subscribe(CAMERA), "id": "b", "image": {"max_width": width}}
    own = f"/soak/churn_{number % 50}"
    yield {"op": "subscribe", "topic": own, "type": "std_msgs/String"}
    yield {"op": "publish", "topic": own, "type": "std_msgs/String", "msg": {"data": "x"}}
    yield {"op": "advertise_service", "service": f"{own}_srv", "type": "std_srvs/SetBool"}
    yield {"op": "call_service", "service": "/rosapi/topics", "id": "t"}
    yield {"op": "call_service", "service": f"{own}_nobody", "id": "n", "type": "std_srvs/SetBool"}
    yield {"op": "graph", "watch": True}
    yield {"op": "subscribe", "topic": "/soak/never", "id": "f", "fragment_size": 100}


async def visit(url: str, number: int, chance: random.Random) -> None:
    """Come, open some things, and leave."""
    opening = list(operations(number, chance))
    async with connect(url, compression=None, proxy=None, max_size=None) as socket:
        for operation in opening[: chance.randint(1, len(opening))]:
            await socket.send(json.dumps(operation))
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(chance.choice([0, 0.1, _LONGEST_S])):
                async for _ in socket:
                    pass
        if chance.random() < 0.5:
            socket.transport.abort()


async def main(url: str) -> None:
    """Come and go until the end of stdin."""
    loop = asyncio.get_running_loop()
    over = asyncio.Event()
    chance = random.Random(1)
    visits = 0
    obey({"count": lambda: visits}, lambda: loop.call_soon_threadsafe(over.set))
    reply("ready")
    while not over.is_set():
        with contextlib.suppress(OSError, WebSocketException, TimeoutError):
            await visit(url, visits, chance)
        visits += 1
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(_REST_S):
                await over.wait()


if __name__ == "__main__":
    asyncio.run(main(sys.argv[1]))
