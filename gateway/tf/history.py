# SPDX-License-Identifier: Apache-2.0
"""The transforms of one frame in its parent over the last seconds."""

from array import array
from bisect import bisect_left, bisect_right
from typing import Final

from gateway.tf.rigid import Rigid

HISTORY_NS: Final = 10_000_000_000  # as tf2 keeps by default
# 10 s at 200 Hz, 130 kB a frame. A faster frame is kept for less time.
MAX_SAMPLES: Final = 2000
# No network delays a sample for this long. A clock that is set back, or a recording that starts
# over, goes back further.
JUMP_BACK_NS: Final = 2_000_000_000

_WIDTH: Final = len(Rigid._fields)


class History:
    """The samples of one frame, sorted by stamp. At least one.

    ``heard_ns`` is the arrival of the newest one, on the caller's clock: stamps may be wrong.
    """

    def __init__(self, stamp_ns: int, parent: str, transform: Rigid, heard_ns: int = 0) -> None:
        self._stamps = array("q", [stamp_ns])
        self._values = array("d", transform)
        # a frame seldom changes its parent: each parent with the stamp from which it applies
        self._starts = array("q", [stamp_ns])
        self._parents = [parent]
        self.heard_ns = heard_ns

    @property
    def oldest_ns(self) -> int:
        """The stamp of the oldest sample."""
        return self._stamps[0]

    @property
    def newest_ns(self) -> int:
        """The stamp of the newest sample."""
        return self._stamps[-1]

    @property
    def parents(self) -> set[str]:
        """The present and former parents."""
        return set(self._parents)

    def parent(self, stamp_ns: int | None) -> str:
        """Return the parent at a time. ``None`` means the newest sample's time."""
        if stamp_ns is None:
            return self._parents[-1]
        return self._parents[max(0, bisect_right(self._starts, stamp_ns) - 1)]

    def add(self, stamp_ns: int, parent: str, transform: Rigid, heard_ns: int = 0) -> bool:
        """Add a sample. Return whether anything has changed.

        A sample replaces an earlier one with the same stamp, as in tf2: without a clock, all stamps
        are 0. A sample from long before the newest begins a new history: time has jumped back.
        """
        self.heard_ns = heard_ns
        if stamp_ns < self.newest_ns - JUMP_BACK_NS:
            self._drop(len(self._stamps))
        at = bisect_left(self._stamps, stamp_ns)
        if at < len(self._stamps) and self._stamps[at] == stamp_ns:
            if (self.parent(stamp_ns), self._value(at)) == (parent, transform):
                return False
            self._remove(at)
        self._hand_over(at, stamp_ns, parent)
        self._stamps.insert(at, stamp_ns)
        self._values[at * _WIDTH : at * _WIDTH] = array("d", transform)
        expired = bisect_left(self._stamps, self.newest_ns - HISTORY_NS)
        self._drop(max(expired, len(self._stamps) - MAX_SAMPLES))
        return True

    def at(self, stamp_ns: int) -> Rigid | None:
        """Return the transform at a time, interpolated between the samples before and after.

        Return ``None`` if the time is before the oldest sample or after the newest.
        """
        after = bisect_left(self._stamps, stamp_ns)
        if after == len(self._stamps):
            return None
        if self._stamps[after] == stamp_ns:
            return self._value(after)
        if not after:
            return None
        before = after - 1
        start_ns, end_ns = self._stamps[before], self._stamps[after]
        if self.parent(start_ns) != self.parent(end_ns):
            return self._value(before)  # as in tf2: nothing lies between two parents
        ratio = (stamp_ns - start_ns) / (end_ns - start_ns)
        return self._value(before).towards(self._value(after), ratio)

    def _value(self, index: int) -> Rigid:
        return Rigid(*self._values[index * _WIDTH : (index + 1) * _WIDTH])

    def _hand_over(self, at: int, stamp_ns: int, parent: str) -> None:
        """Record the parent of a sample about to be inserted at *at*. The others keep theirs."""
        run = bisect_right(self._starts, stamp_ns)
        if run and self._parents[run - 1] == parent:
            return
        following = self._stamps[at : at + 1]
        if run and following and following != self._starts[run : run + 1]:
            self._starts.insert(run, following[0])
            self._parents.insert(run, self._parents[run - 1])
        self._starts.insert(run, stamp_ns)
        self._parents.insert(run, parent)

    def _remove(self, at: int) -> None:
        """Remove one sample. The others keep their parents."""
        stamp_ns = self._stamps.pop(at)
        del self._values[at * _WIDTH : (at + 1) * _WIDTH]
        run = bisect_right(self._starts, stamp_ns) - 1
        if self._starts[run] != stamp_ns:
            return
        following = self._stamps[at : at + 1]
        if following and following != self._starts[run + 1 : run + 2]:
            self._starts[run] = following[0]
        else:
            del self._starts[run], self._parents[run]

    def _drop(self, count: int) -> None:
        if count > 0:
            del self._stamps[:count]
            del self._values[: count * _WIDTH]
            first = bisect_right(self._starts, self._stamps[0]) - 1 if self._stamps else None
            del self._starts[:first]
            del self._parents[:first]
            self._starts[:1] = self._stamps[:1]
