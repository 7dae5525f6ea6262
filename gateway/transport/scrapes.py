# SPDX-License-Identifier: Apache-2.0
"""The pages for Prometheus: written a slice at a time, one page after the other."""

import asyncio
import logging
import time
from collections.abc import Callable
from typing import Final

from gateway.access.permissions import Identity, Permissions
from gateway.metrics.page import pieces
from gateway.metrics.state import State, seen_by

# With 32 clients of 64 topics each a page takes 100 ms, which is too long for others to wait.
SLICE_S: Final = 0.002
# After a slice it rests three times as long, so pages take at most a quarter of the loop.
REST: Final = 3

logger = logging.getLogger(__name__)

Reply = Callable[[bytes | None], None]


class Scrapes:
    """Answers all requests that arrive while a page for their role is written with that page."""

    def __init__(self, state: Callable[[], State]) -> None:
        self._state = state
        self._waiting: dict[Permissions, list[Reply]] = {}
        self._task: asyncio.Task[None] | None = None

    def ask(self, identity: Identity, reply: Reply) -> None:
        """Give *reply* the page that this client may see, or ``None`` if that fails."""
        self._waiting.setdefault(identity.permissions, []).append(reply)
        if self._task is None:
            self._task = asyncio.get_running_loop().create_task(self._write_all())

    def close(self) -> None:
        """Write nothing any more."""
        self._waiting.clear()
        if self._task is not None:
            self._task.cancel()

    async def _write_all(self) -> None:
        try:
            while self._waiting:
                permissions = next(iter(self._waiting))
                try:
                    page = await self._write(permissions)
                except Exception:  # a fault of the gateway must not affect others
                    logger.exception("writing the metrics failed")
                    page = None
                for reply in self._waiting.pop(permissions, ()):
                    begun_s = time.monotonic()
                    reply(page)
                    await asyncio.sleep(REST * (time.monotonic() - begun_s))
        finally:
            self._task = None

    async def _write(self, permissions: Permissions) -> bytes:
        written = []
        begun_s = time.monotonic()
        for piece in pieces(seen_by(self._state(), permissions.sees)):
            written.append(piece)
            took_s = time.monotonic() - begun_s
            if took_s > SLICE_S:
                await asyncio.sleep(REST * took_s)
                begun_s = time.monotonic()
        page = "".join(written).encode()
        await asyncio.sleep(REST * (time.monotonic() - begun_s))
        return page
