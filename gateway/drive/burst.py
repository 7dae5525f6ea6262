# SPDX-License-Identifier: Apache-2.0
"""Commands that arrive together after a silence, as after a network failure.

They come in segments of TCP, several commands in one turn of the event loop, and the next segment a
little later. So for a while after a silence, time must explain each command beyond the first of a
turn: one for each `PERIOD_NS`, because the loop or the network may have stood still while a client
sent that fast. Commands that are `BACKLOG` ahead of time are a backlog.
"""

from collections.abc import Hashable
from typing import Final

PERIOD_NS: Final = 1_000_000_000 // 120  # XR's rate
BACKLOG: Final = 12  # 100 ms of a busy loop, and less than a backlog of 1 s at 20 Hz
WATCHED_NS: Final = 250_000_000


class Burst:
    """The commands of one client after a silence, and the time that explains all of them."""

    def __init__(self) -> None:
        self.explained_ns = 0
        self._client: Hashable = None
        self._heard_ns: int | None = None
        self._watched_until_ns = 0
        self._is_first = True  # of its turn

    def hear(self, client: Hashable, now_ns: int, silence_ns: int) -> int | None:
        """Note any command, and return the time since the one before, if there was one.

        After *silence_ns*, or another client, the commands are watched.
        """
        gap_ns = None if self._heard_ns is None else now_ns - self._heard_ns
        if gap_ns is None or gap_ns >= silence_ns or client != self._client:
            self._watched_until_ns = now_ns + WATCHED_NS
            self.explained_ns = now_ns
        self._client, self._heard_ns = client, now_ns
        return gap_ns

    def add(self, client: Hashable, now_ns: int, silence_ns: int) -> int | None:
        """Count a command that may go out, and return what `hear` does."""
        gap_ns = self.hear(client, now_ns, silence_ns)
        if not self._is_first and now_ns < self._watched_until_ns:
            # no more: a backlog needs no explanation
            most_ns = now_ns + BACKLOG * PERIOD_NS
            self.explained_ns = min(self.explained_ns + PERIOD_NS, most_ns)
        self._is_first = False
        return gap_ns

    def end_turn(self) -> bool:
        """Return whether the commands of this turn belong to a backlog."""
        is_backlog = self.explained_ns - (self._heard_ns or 0) >= BACKLOG * PERIOD_NS
        is_empty, self._is_first = self._is_first, True
        return is_backlog and not is_empty
