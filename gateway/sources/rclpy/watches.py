# SPDX-License-Identifier: Apache-2.0
"""Callbacks for changes of the graph, and for simulated time that jumps back.

It jumps back if a simulation was reset, or a recording starts over.
"""

import asyncio
from collections.abc import Callable
from typing import Final

from rclpy.clock import Clock, JumpThreshold, TimeJump
from rclpy.duration import Duration

# A robot that starts changes its graph for seconds, and each watcher reads it again, ~10 ms for a
# big one: ten times a second is often enough for people.
SETTLE_S: Final = 0.1
# any jump, as for tf2's listeners. Without simulated time it never jumps
_BACK: Final = JumpThreshold(
    min_forward=None, min_backward=Duration(nanoseconds=-1), on_clock_change=False
)


class GraphWatch:
    """One watch of the graph."""

    def __init__(self, watches: "GraphWatches", on_change: Callable[[], None]) -> None:
        self._watches = watches
        self._on_change = on_change

    def close(self) -> None:
        """End it. No callback comes after. Closing twice is harmless."""
        self._watches.remove(self)

    def notify(self) -> None:
        """Report a change."""
        self._on_change()


class GraphWatches:
    """All watches, notified together `SETTLE_S` after the first change."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop
        self._open: dict[GraphWatch, None] = {}
        self._timer: asyncio.TimerHandle | None = None

    def add(self, on_change: Callable[[], None]) -> GraphWatch:
        """Open a watch."""
        watch = GraphWatch(self, on_change)
        self._open[watch] = None
        return watch

    def remove(self, watch: GraphWatch) -> None:
        """Close a watch. One that is not open is ignored."""
        self._open.pop(watch, None)

    def notify(self) -> None:
        """Schedule the report of a change."""
        if self._timer is None and self._open:
            self._timer = self._loop.call_later(SETTLE_S, self._notify_all)

    def close(self) -> None:
        """Close all watches."""
        self._open.clear()
        if self._timer is not None:
            self._timer.cancel()

    def _notify_all(self) -> None:
        self._timer = None
        for watch in list(self._open):
            if watch in self._open:  # an earlier one may have closed it
                watch.notify()


class JumpWatch:
    """Calls *on_jump* on the event loop that runs now, whichever thread sets the time."""

    def __init__(self, clock: Clock, on_jump: Callable[[], None]) -> None:
        loop = asyncio.get_running_loop()
        self._on_jump: Callable[[], None] | None = on_jump

        def pass_on(_: TimeJump) -> None:
            loop.call_soon_threadsafe(self._notify)

        self._handle = clock.create_jump_callback(_BACK, post_callback=pass_on)

    def close(self) -> None:
        """End it. No callback comes after. Closing twice is harmless."""
        self._on_jump = None
        self._handle.unregister()

    def _notify(self) -> None:
        if self._on_jump is not None:
            self._on_jump()
