# SPDX-License-Identifier: Apache-2.0
"""The event loop's clock, stopped: what waits for seconds is tested in none."""

import asyncio

import pytest


class StoppedClock:
    """The clock of the running loop. It goes on by `advance` alone.

    While it stands, only what is ready at once happens: nothing may wait by `asyncio.sleep` or
    `tests.client.eventually`.
    """

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        loop = asyncio.get_running_loop()
        self.now_s = loop.time()
        monkeypatch.setattr(loop, "time", lambda: self.now_s)

    def jump(self, seconds: float) -> None:
        """Let so much time pass in which nothing happens, as while the loop is blocked."""
        self.now_s += seconds

    async def advance(self, seconds: float) -> None:
        """Let so much time pass at once, and everything happen that is due then."""
        self.jump(seconds)
        for _ in range(20):
            await asyncio.sleep(0)
