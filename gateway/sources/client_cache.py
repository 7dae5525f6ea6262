# SPDX-License-Identifier: Apache-2.0
"""Things that are costly to open and stay open for a while after their last use."""

import asyncio
import contextlib
from collections.abc import Callable, Hashable, Iterator
from dataclasses import dataclass
from typing import Final, Generic, Protocol, TypeVar

# DDS takes some tenths of a second until a server discovers a new client, so a caller once a second
# must not pay that each time. Nor must an unused client stay visible in the graph for long.
IDLE_S: Final = 5.0
MAX_IDLE: Final = 128  # of 1280 ROS entities. A robot with Navigation 2 has about 70 nodes


class Closable(Protocol):
    """Something that is open until it is closed."""

    def close(self) -> None:
        """Close it. Closing twice is harmless."""


T = TypeVar("T", bound=Closable)


@dataclass(slots=True)
class _Entry(Generic[T]):
    thing: T
    users: int = 0
    end: asyncio.TimerHandle | None = None


class ClientCache(Generic[T]):
    """Opens each thing once for all its users, and closes it `IDLE_S` after the last use."""

    def __init__(self) -> None:
        self._entries: dict[Hashable, _Entry[T]] = {}

    def __len__(self) -> int:
        """Count the open entries."""
        return len(self._entries)

    @contextlib.contextmanager
    def use(self, key: Hashable, open_thing: Callable[[], T]) -> Iterator[T]:
        """Lend the thing of *key*. *open_thing* opens it if it is not open yet."""
        entry = self._entries.get(key)
        if entry is None:
            entry = self._entries[key] = _Entry(open_thing())
        elif entry.end is not None:
            entry.end.cancel()
            entry.end = None
        entry.users += 1
        try:
            yield entry.thing
        finally:
            entry.users -= 1
            if not entry.users and self._entries.get(key) is entry:
                self._entries[key] = self._entries.pop(key)  # the longest idle comes first
                loop = asyncio.get_running_loop()
                entry.end = loop.call_later(IDLE_S, self._close, key)
                self._shed()

    def close(self) -> None:
        """Close everything, in use or not."""
        for key in list(self._entries):
            self._close(key)

    def _shed(self) -> None:
        idle = [key for key, entry in self._entries.items() if not entry.users]
        for key in idle[: max(0, len(idle) - MAX_IDLE)]:
            self._close(key)

    def _close(self, key: Hashable) -> None:
        entry = self._entries.pop(key)
        if entry.end is not None:
            entry.end.cancel()
        entry.thing.close()
