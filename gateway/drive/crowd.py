# SPDX-License-Identifier: Apache-2.0
"""Commands that come at once after a silence, as those do that a link delivers after it was dead.

They come in segments of TCP, several commands in one turn of the event loop, and the next segment a
little later. So for a while after a silence each command beyond the first of a turn has to be
explained by time: one every `PERIOD_NS`, as the loop may have been busy while a client sent that
fast. What time has yet to explain waits, and what is `CROWD` commands ahead of it is a backlog.
"""

from typing import Final

from gateway.drive.trip_latch import QUIET_NS

PERIOD_NS: Final = 1_000_000_000 // 120  # no client is faster than XR's 120 Hz
CROWD: Final = 12  # 100 ms while the loop was busy; less than a backlog of 1 s at 20 Hz
# A slower client is silent between any two commands, and each comes alone.
SILENCE_NS: Final = QUIET_NS
WATCHED_NS: Final = QUIET_NS


class Crowd:
    """The commands after a silence, and the time by which all of them are explained."""

    def __init__(self) -> None:
        self.explained_ns = 0
        self._heard_ns: int | None = None
        self._watched_until_ns = 0
        self._is_first = True  # of its turn
        self._is_backlog = False

    def hear(self, now_ns: int) -> int | None:
        """Take note of any command, and return the time since the one before, if there was one."""
        gap_ns = None if self._heard_ns is None else now_ns - self._heard_ns
        self._heard_ns = now_ns
        return gap_ns

    def add(self, now_ns: int) -> int | None:
        """Take a command that may move the robot or stop it, and return what `hear` does."""
        gap_ns = self.hear(now_ns)
        if gap_ns is None or gap_ns >= SILENCE_NS:
            self._watched_until_ns = now_ns + WATCHED_NS
            self.explained_ns = now_ns
        if not self._is_first and now_ns < self._watched_until_ns:
            self.explained_ns = max(self.explained_ns, now_ns) + PERIOD_NS
            self._is_backlog |= self.explained_ns - now_ns >= CROWD * PERIOD_NS
        self._is_first = False
        return gap_ns

    def end_turn(self) -> bool:
        """Return whether the commands of this turn belong to a backlog."""
        is_backlog, self._is_backlog = self._is_backlog, False
        self._is_first = True
        return is_backlog
