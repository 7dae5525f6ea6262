# SPDX-License-Identifier: Apache-2.0
"""Callbacks for changes of the graph."""

import asyncio
from collections.abc import Callable
from typing import Final

# A robot that starts changes its graph for seconds, and each watcher reads it again, ~10 ms for a
# big one: ten times a second is often enough for people.
SETTLE_S: Final = 0.1


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
