# SPDX-License-Identifier: Apache-2.0
"""The pauses between the messages of a topic, and how much of them a control heard."""

import time
from collections.abc import Sequence

Gap = tuple[float, float]
"""From when to when nothing came, by the monotonic clock in seconds."""

SHORTEST_S = 0.2  # of the pauses that are kept: with one in ten seconds, 600 minutes fit in 200 kB


class Silences:
    """The longer pauses of one topic."""

    def __init__(self) -> None:
        self.count = 0
        self._last_s: float | None = None
        self._gaps: list[Gap] = []

    def hear(self, now_s: float) -> None:
        """Take the time of a message."""
        self.count += 1
        if self._last_s is not None and now_s - self._last_s > SHORTEST_S:
            self._gaps.append((self._last_s, now_s))
        self._last_s = now_s

    def so_far(self) -> list[Gap]:
        """Return the pauses, with the one that may just last."""
        now_s = time.monotonic()
        return self._gaps + ([(self._last_s, now_s)] if self._last_s is not None else [])


def beyond_control(gap: Gap, control: Sequence[Gap]) -> float:
    """Return the seconds of a pause in which a control heard something. Its pauses may overlap."""
    extra_s, reached_s = 0.0, gap[0]
    for since, until in sorted((begin, end) for begin, end in control):  # also lists of JSON
        extra_s += max(0.0, min(since, gap[1]) - reached_s)
        reached_s = max(reached_s, min(until, gap[1]))
    return extra_s + gap[1] - reached_s
