# SPDX-License-Identifier: Apache-2.0
"""A client for tests: the library's own WebSocket client, and frames as dicts."""

import asyncio
import contextlib
import json
from collections.abc import AsyncIterator, Callable
from typing import Any, TypeVar

from websockets.asyncio.client import ClientConnection, connect

TIMEOUT_S = 120  # a busy machine may take its time. Nothing here measures it

Frame = dict[str, Any]
T = TypeVar("T")


class Client:
    """Sends operations and waits for the frames that matter."""

    def __init__(self, socket: ClientConnection) -> None:
        self.socket = socket
        self.seen: list[Frame] = []

    async def send(self, **operation: Any) -> None:
        """Send one operation."""
        await self.socket.send(json.dumps(operation))

    async def receive(
        self, wanted: Callable[[Frame], bool] = lambda frame: True, within_s: float = TIMEOUT_S
    ) -> Frame:
        """Return the next frame that is wanted. The others are kept in `seen`."""
        async with asyncio.timeout(within_s):
            while True:
                frame = json.loads(await self.socket.recv())
                if wanted(frame):
                    return frame
                self.seen.append(frame)

    async def status(self) -> Frame:
        """Return the next status."""
        return await self.receive(lambda frame: frame["op"] == "status")

    async def message(self, topic: str) -> Any:
        """Return the next message of a topic."""
        frame = await self.receive(
            lambda frame: frame["op"] == "publish" and frame["topic"] == topic
        )
        return frame["msg"]

    async def sync(self) -> list[Frame]:
        """Wait until everything sent so far was carried out. Return what came in the meantime."""
        self.seen.clear()
        await self.send(op="ping", id="sync")
        await self.receive(lambda frame: frame["op"] == "pong" and frame.get("id") == "sync")
        return list(self.seen)


@contextlib.asynccontextmanager
async def client(
    url: str, *, level: str | None = "warning", **options: Any
) -> AsyncIterator[Client]:
    """Connect a client, without proxies, compression or limits in the way.

    Its address asks for a `status` of *level* or worse. Without one it is as a client of rosbridge.
    """
    if level is not None:
        url += f"{'&' if '?' in url else '?'}status={level}"
    options = {
        "compression": None,
        "max_size": None,
        "proxy": None,
        "ping_interval": None,
        **options,
    }
    async with connect(url, **options) as socket:
        yield Client(socket)


async def eventually(condition: Callable[[], bool], within_s: float = TIMEOUT_S) -> None:
    """Wait until something holds."""
    async with asyncio.timeout(within_s):
        while not condition():  # noqa: ASYNC110  # of anything, without its cooperation
            await asyncio.sleep(0.01)


async def eventually_equal(look: Callable[[], T], expected: T) -> None:
    """Wait until what is seen is what is expected. After that, show where it differs."""
    try:
        await eventually(lambda: look() == expected)
    except TimeoutError:
        assert look() == expected
        raise
