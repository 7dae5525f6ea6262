# SPDX-License-Identifier: Apache-2.0
"""The publishers whose samples arrive: what is lost of each, and whether the graph has it."""

import time
from collections.abc import Callable
from typing import Final

# One that publishes once and ends has a new id each time. Beyond these, the oldest is forgotten.
MAX_PUBLISHERS: Final = 1024
# A larger step shows a new start, or a stranger. At 1 kHz, a million samples take 17 minutes.
MAX_GAP: Final = 1_000_000
RECENT_S: Final = 5.0
# After a router has started again, tokens come back within 4 s.
GRACE_S: Final = 10.0


class SampleNumbers:
    """Counts the samples of one topic that never came, by the numbers that publishers give them."""

    def __init__(self) -> None:
        self._next: dict[bytes, int] = {}
        self.lost = 0

    def note(self, gid: bytes, number: int) -> None:
        """Note a sample. One that was overtaken has been counted as lost already."""
        expected = self._next.get(gid)
        if expected is None:
            if len(self._next) >= MAX_PUBLISHERS:
                del self._next[next(iter(self._next))]
        elif abs(number - expected) <= MAX_GAP:
            if number < expected:
                return
            self.lost += number - expected
        self._next[gid] = number + 1


class UnlistedPublishers:
    """Finds publishers whose data come and whose tokens do not, for a while."""

    def __init__(self, is_listed: Callable[[bytes], bool]) -> None:
        self._is_listed = is_listed
        self._heard_s: dict[bytes, float] = {}
        self._since_s: float | None = None

    def hear(self, gid: bytes) -> None:
        """Note that a sample has arrived."""
        if gid not in self._heard_s and len(self._heard_s) >= MAX_PUBLISHERS:
            del self._heard_s[next(iter(self._heard_s))]
        self._heard_s[gid] = time.monotonic()

    def count(self) -> int:
        """Return how many there are, 0 within the first `GRACE_S`. Ask every few seconds."""
        now_s = time.monotonic()
        found = sum(
            now_s - heard_s < RECENT_S and not self._is_listed(gid)
            for gid, heard_s in self._heard_s.items()
        )
        if not found:
            self._since_s = None
            return 0
        if self._since_s is None:
            self._since_s = now_s
        return found if now_s - self._since_s >= GRACE_S else 0
