# SPDX-License-Identifier: Apache-2.0
"""The pace of a throttled subscription."""

from collections import deque
from typing import Final, NamedTuple

from gateway.protocol.outbox import Entry

MAX_HELD_BYTES: Final = 8 * 1024**2  # as much as waits for a socket; but one entry always


class Pace(NamedTuple):
    """The interval of a throttle, 0 for none, and the number of entries that wait for one."""

    interval_ns: int
    length: int = 1


class Throttle:
    """Lets at most one entry pass per interval.

    The first passes at once. What comes before its interval is over is held, and passes at the end
    of this or a later one; so the last entry of all passes, too. If more are held than the pace's
    length says, the oldest makes room: with one, the newest of each interval passes.
    """

    __slots__ = ("_held", "_held_bytes", "_pace", "due_ns")

    def __init__(self, pace: Pace) -> None:
        self._pace = pace
        self._held: deque[Entry] = deque()
        self._held_bytes = 0
        self.due_ns = 0  # when the next entry may pass

    def __len__(self) -> int:
        """Count the entries that wait for the end of an interval."""
        return len(self._held)

    def passes(self, now_ns: int) -> bool:
        """Return whether an entry may pass now; else `hold` it, and `release` one at `due_ns`."""
        if self._held or now_ns < self.due_ns:
            return False
        self._keep_the_beat(now_ns)
        return True

    def hold(self, entry: Entry) -> int:
        """Hold an entry; return how many have made room for it."""
        self._held.append(entry)
        self._held_bytes += entry.size
        before = len(self._held)
        while len(self._held) > self._pace.length or (
            self._held_bytes > MAX_HELD_BYTES and len(self._held) > 1
        ):
            self._take()
        return before - len(self._held)

    def release(self, now_ns: int) -> Entry | None:
        """Return the entry that was held for longest, at the end of an interval."""
        if not self._held:
            return None
        self._keep_the_beat(now_ns)
        return self._take()

    def clear(self) -> None:
        """Forget the entries that are held."""
        self._held.clear()
        self._held_bytes = 0

    def _take(self) -> Entry:
        entry = self._held.popleft()
        self._held_bytes -= entry.size
        return entry

    def _keep_the_beat(self, now_ns: int) -> None:
        # While entries come in time the beat goes on, however late a timer is; after a pause a
        # new one begins.
        is_in_time = now_ns - self.due_ns < self._pace.interval_ns
        self.due_ns = (self.due_ns if is_in_time else now_ns) + self._pace.interval_ns
