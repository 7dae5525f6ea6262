# SPDX-License-Identifier: Apache-2.0
"""Drives a page with the gateway's .jslib, as the player's main loop would."""

import asyncio
import base64
import contextlib
from asyncio.subprocess import PIPE, Process
from collections.abc import AsyncIterator, Awaitable, Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

HERE: Final = Path(__file__).parent
LIBRARY: Final = HERE.parents[2] / "unity_client/client/Runtime/Unity/WebGL/Ros2Gateway.jslib"

CONNECTING: Final = 0
OPEN: Final = 1
CLOSED: Final = 3

TIMEOUT_S: Final = 120  # a busy machine takes its time
_INTERVAL_S: Final = 0.005  # between two looks, as a player looks once a frame
_LINE_BYTES: Final = 64 * 1024 * 1024  # a frame in base64


@dataclass
class Page:
    """A running page."""

    process: Process

    async def call(self, name: str, *arguments: object) -> tuple[int, bytes]:
        """Call one of the library's functions. Bytes go in by pointer, a bytearray comes out."""
        words = [name, *map(_word, arguments)]
        self.process.stdin.write(" ".join(words).encode() + b"\n")
        async with asyncio.timeout(TIMEOUT_S):
            await self.process.stdin.drain()
            line = await self.process.stdout.readline()
        assert line, "the page ended"
        number, _, output = line.decode().rstrip("\n").partition(" ")
        return int(number), base64.b64decode(output)

    async def open(
        self, url: str, *, message_bytes: int = 16 * 2**20, inbox_bytes: int = 64 * 2**20
    ) -> "PageSocket":
        """Begin to connect."""
        address = url.encode()
        arguments = (address, len(address), message_bytes, inbox_bytes)
        handle, _ = await self.call("Open", *arguments)
        return PageSocket(self, handle)


@dataclass
class PageSocket:
    """One socket of a page."""

    page: Page
    handle: int

    async def state(self) -> int:
        """Return 0 to 3, as ``WebSocket.readyState``."""
        return (await self.page.call("State", self.handle))[0]

    async def frame_bytes(self) -> int:
        """Return the size of the frame that waits longest, or -1."""
        return (await self.page.call("FrameBytes", self.handle))[0]

    async def receive(self, capacity: int = 16 * 2**20) -> tuple[int, bytes]:
        """Take that frame."""
        return await self.page.call("Receive", self.handle, bytearray(capacity), capacity)

    async def send(self, frame: bytes) -> int:
        """Send a frame of text."""
        return (await self.page.call("Send", self.handle, frame, len(frame)))[0]

    async def buffered_bytes(self) -> int:
        """Return what the network has not taken yet."""
        return (await self.page.call("BufferedBytes", self.handle))[0]

    async def close(self, code: int, reason: str) -> None:
        """Say goodbye."""
        text = reason.encode()
        await self.page.call("Close", self.handle, code, text, len(text))

    async def closed(self) -> tuple[int, str]:
        """Wait for the end, and return code and reason."""
        await self.until(CLOSED)
        code, _ = await self.page.call("CloseCode", self.handle)
        _, reason = await self.page.call("CloseReason", self.handle, bytearray(512), 512)
        return code, reason.decode()

    async def until(self, state: int) -> None:
        """Wait for a state."""
        await until(self.state, lambda now: now == state)

    async def next_frame(self) -> bytes:
        """Wait for a frame and take it."""
        await until(self.frame_bytes, lambda size: size >= 0)
        return (await self.receive())[1]


@contextlib.asynccontextmanager
async def page(kind: str = "") -> AsyncIterator[Page]:
    """Run a page. ``shared`` has memory that threads share, ``high`` has it beyond 2 GiB."""
    process = await asyncio.create_subprocess_exec(
        *command(kind), stdin=PIPE, stdout=PIPE, limit=_LINE_BYTES
    )
    try:
        yield Page(process)
    finally:
        process.stdin.close()
        async with asyncio.timeout(TIMEOUT_S):
            await process.wait()


async def until(look: Callable[[], Awaitable[int]], wanted: Callable[[int], bool]) -> None:
    """Look until a number is as wanted."""
    async with asyncio.timeout(TIMEOUT_S):
        while not wanted(await look()):  # noqa: ASYNC110  # the page tells nothing by itself
            await asyncio.sleep(_INTERVAL_S)


def command(kind: str = "") -> list[str]:
    """Return what runs a page."""
    flags = ["--no-warnings", "--experimental-websocket"]
    return ["node", *flags, str(HERE / "page.mjs"), str(LIBRARY), kind]


def _word(argument: object) -> str:
    match argument:
        case bytearray():
            return f"o:{len(argument)}"
        case bytes():
            return f"b:{base64.b64encode(argument).decode()}"
        case _:
            return str(argument)
