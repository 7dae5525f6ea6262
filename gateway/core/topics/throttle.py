# SPDX-License-Identifier: Apache-2.0
"""The pace of a throttled subscription."""

from collections import Counter, deque
from itertools import pairwise
from typing import Final, NamedTuple

from gateway.core.entries import Entry

MAX_HELD_BYTES: Final = 8 * 1024**2  # as much as waits for a socket, but always one entry
# Of a latched topic: a robot has a dozen on /tf_static.
MAX_HELD_PUBLISHERS: Final = 256


class Pace(NamedTuple):
    """The interval of a throttle, 0 for none, and the number of entries that wait for one."""

    interval_ns: int
    length: int = 1


class Throttle:
    """Lets at most one entry pass per interval.

    The first passes at once. An entry that comes before its interval is over is held, and passes at
    the end of this or a later one. So the last entry of all also passes. If more are held than the
    pace's length says, the oldest makes room: with one, the newest of each interval passes. If
    publishers are told apart, an entry makes room only for newer ones of the same publisher.
    """

    __slots__ = ("_held", "_held_bytes", "_pace", "_publishers", "due_ns")

    def __init__(self, pace: Pace) -> None:
        self._pace = pace
        self._held: deque[tuple[bytes | None, Entry]] = deque()
        self._publishers: Counter[bytes | None] = Counter()  # of what is held
        self._held_bytes = 0
        self.due_ns = 0  # when the next entry may pass

    def __len__(self) -> int:
        """Count the entries that wait for the end of an interval."""
        return len(self._held)

    def passes(self, now_ns: int) -> bool:
        """Return whether an entry may pass now. Else `hold` it, and `release` one at `due_ns`."""
        if self._held or now_ns < self.due_ns:
            return False
        self._keep_the_beat(now_ns)
        return True

    def hold(self, entry: Entry, publisher: bytes | None = None) -> int:
        """Hold an entry. Return how many have made room for it."""
        self._held.append((publisher, entry))
        self._publishers[publisher] += 1
        self._held_bytes += entry.size
        before = len(self._held)
        if self._publishers[publisher] > self._pace.length:
            self._replace_oldest(publisher)
        while len(self._publishers) > MAX_HELD_PUBLISHERS or (
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
        self._publishers.clear()
        self._held_bytes = 0

    def _replace_oldest(self, publisher: bytes | None) -> None:
        """Let each entry of a publisher take the place of the one before it.

        Behind those of the others, a publisher that is faster than they are would never have a
        turn.
        """
        if len(self._publishers) == 1:
            self._take()
            return
        held = self._held
        places = [at for at, (each, _) in enumerate(held) if each == publisher]
        oldest = held[places[0]]
        for at, following in pairwise(places):
            held[at] = held[following]
        held[-1] = oldest
        self._take(-1)

    def _take(self, at: int = 0) -> Entry:
        publisher, entry = self._held[at]
        del self._held[at]
        self._held_bytes -= entry.size
        self._publishers[publisher] -= 1
        if not self._publishers[publisher]:
            del self._publishers[publisher]
        return entry

    def _keep_the_beat(self, now_ns: int) -> None:
        # While entries come in time the beat goes on, however late a timer is. After a pause a
        # new one begins.
        is_in_time = now_ns - self.due_ns < self._pace.interval_ns
        self.due_ns = (self.due_ns if is_in_time else now_ns) + self._pace.interval_ns
