# SPDX-License-Identifier: Apache-2.0
"""Counts of observed times, by buckets."""

from bisect import bisect_left
from typing import Final, NamedTuple

# From a frame that is written at once to one that waited as long as possible.
TIME_BOUNDS_S: Final = (
    *(0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05),
    *(0.1, 0.2, 0.5, 1.0, 2.0, 5.0),
)


class Observed(NamedTuple):
    """A histogram at one moment. The last of *counts* is beyond all bounds."""

    counts: tuple[int, ...]
    sum_s: float

    def buckets(self) -> list[tuple[str, float]]:
        """Return the bounds with the cumulative counts, as Prometheus wants them."""
        total = 0
        buckets = []
        for bound, count in zip((*map(str, TIME_BOUNDS_S), "+Inf"), self.counts, strict=True):
            total += count
            buckets.append((bound, float(total)))
        return buckets


class Histogram:
    """Counts times in seconds by `TIME_BOUNDS_S`."""

    __slots__ = ("_counts", "_sum_s")

    def __init__(self) -> None:
        self._counts = [0] * (len(TIME_BOUNDS_S) + 1)
        self._sum_s = 0.0

    def observe(self, time_s: float) -> None:
        """Count a time. A negative one, after a clock was set, counts as 0."""
        time_s = max(0.0, time_s)
        self._counts[bisect_left(TIME_BOUNDS_S, time_s)] += 1
        self._sum_s += time_s

    def observed(self) -> Observed:
        """Return what was counted so far."""
        return Observed(tuple(self._counts), self._sum_s)


NOTHING_OBSERVED: Final = Histogram().observed()
