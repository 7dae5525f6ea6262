# SPDX-License-Identifier: Apache-2.0
"""The timer of a drive's next action."""

import asyncio
import time
from collections.abc import Callable


class DriveTimer:
    """Calls *tick* with the time when a drive has something to do."""

    def __init__(self, tick: Callable[[int], None]) -> None:
        self._tick = tick
        self._timer: asyncio.TimerHandle | None = None
        self._due_ns = 0
        self._is_closed = False

    def set(self, due_ns: int | None) -> None:
        """Call at this time. A timer that comes too early sets the next."""
        if self._is_closed or due_ns is None or (self._timer and self._due_ns <= due_ns):
            return
        if self._timer:
            self._timer.cancel()
        delay_s = max(0.0, (due_ns - time.monotonic_ns()) / 1e9)
        self._timer = asyncio.get_running_loop().call_later(delay_s, self._on_timer)
        self._due_ns = due_ns

    def close(self) -> None:
        """Call no more."""
        self._is_closed = True
        if self._timer:
            self._timer.cancel()
            self._timer = None

    def _on_timer(self) -> None:
        self._timer = None
        self._tick(time.monotonic_ns())
