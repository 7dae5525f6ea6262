# SPDX-License-Identifier: Apache-2.0
"""The rate at which the looks at a buffer of transforms follow its changes."""

import asyncio
from collections.abc import Callable


class RateLimiter:
    """Calls *turn* after it was woken, at most at a rate."""

    def __init__(self, rate_hz: float, turn: Callable[[], None]) -> None:
        """Call *turn* for the first time in the next turn of the loop."""
        self._period_s = 1 / rate_hz
        self._turn = turn
        self._loop = asyncio.get_running_loop()
        self._due_s = 0.0
        self._timer: asyncio.TimerHandle | None = None
        self.wake()

    def wake(self) -> None:
        """Take a turn when the rate allows it: there may be something new."""
        if self._timer is None:
            self._due_s = max(self._due_s, self._loop.time())
            self._timer = self._loop.call_at(self._due_s, self._take_turn)

    def retry_after(self, wait_s: float) -> None:
        """Let the next turn be due after *wait_s*, if that is sooner: this one sent nothing."""
        self._due_s = min(self._due_s, self._loop.time() + wait_s)

    def stop(self) -> None:
        """Take no turn until it is woken again."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _take_turn(self) -> None:
        self._timer = None
        # keep the period. Begin a new one if the loop has been busy for longer than that
        self._due_s = max(self._due_s + self._period_s, self._loop.time())
        self._turn()
