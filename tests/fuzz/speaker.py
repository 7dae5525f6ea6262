# SPDX-License-Identifier: Apache-2.0
"""A client of the conversations: it keeps all frames that come, and how its connection ends."""

import asyncio
import contextlib
import json
from typing import Any

import cbor2
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed

from tests.client import TIMEOUT_S, Frame
from tests.fuzz.target import check


class Speaker:
    """Sends operations in JSON, or anything else. Used on the loop that opened it."""

    def __init__(self, socket: ClientConnection) -> None:
        self.socket = socket
        self.frames: list[Frame] = []
        self.close_code: int | None = None
        self._pieces: dict[str, dict[int, str]] = {}
        self._news = asyncio.Condition()
        self._reading = asyncio.create_task(self._read())

    @classmethod
    async def open(cls, url: str) -> "Speaker":
        return cls(
            await connect(f"{url}?status=warning", compression=None, max_size=None, proxy=None)
        )

    async def say(self, text: str | bytes) -> None:
        """Send a frame, unless the connection is over."""
        with contextlib.suppress(ConnectionClosed):
            await self.socket.send(text)

    async def until(self, condition: Any) -> None:
        """Wait until something holds of the frames or the end."""
        async with asyncio.timeout(TIMEOUT_S), self._news:
            await self._news.wait_for(condition)

    async def cut(self) -> None:
        """Vanish without a word."""
        self.socket.transport.abort()
        await self._reading

    async def leave(self) -> None:
        """Close in order."""
        await self.socket.close()
        await self._reading

    async def _read(self) -> None:
        try:
            async for message in self.socket:
                self._keep(message)
                async with self._news:
                    self._news.notify_all()
        except ConnectionClosed:
            pass
        finally:
            self.close_code = self.socket.close_code
            async with self._news:
                self._news.notify_all()

    def _keep(self, message: str | bytes) -> None:
        frame = cbor2.loads(message) if isinstance(message, bytes) else strict_json(message)
        if frame.get("op") == "fragment":
            pieces = self._pieces.setdefault(frame["id"], {})
            check(frame["num"] not in pieces, "a piece came twice")
            pieces[frame["num"]] = frame["data"]
            if len(pieces) < frame["total"]:
                return
            text = "".join(pieces[number] for number in range(frame["total"]))
            del self._pieces[frame["id"]]
            frame = strict_json(text)
        self.frames.append(frame)


def strict_json(text: str) -> Any:
    """Read JSON as the standard says: without NaN and infinities."""
    return json.loads(text, parse_constant=_refuse)


def _refuse(constant: str) -> None:
    raise ValueError(f"{constant} is no JSON")
