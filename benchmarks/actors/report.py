# SPDX-License-Identifier: Apache-2.0
"""A receiver's record of messages, and its summary."""

import statistics
from array import array
from collections.abc import Sequence
from typing import Any


class Ages:
    """The stamps of messages and their ages on arrival, in nanoseconds.

    One thread adds, another may read: each stamp is added last, and only messages with one count.
    """

    def __init__(self) -> None:
        self._ages_ns = array("q")
        self._stamps_ns = array("q")

    def __len__(self) -> int:
        return len(self._stamps_ns)

    def add(self, stamp_ns: int, now_ns: int) -> None:
        """Record one message."""
        self._ages_ns.append(now_ns - stamp_ns)
        self._stamps_ns.append(stamp_ns)

    def clear(self) -> bool:
        """Forget the messages so far. Call it while none arrive."""
        self._ages_ns, self._stamps_ns = array("q"), array("q")
        return True

    def summary(self) -> dict[str, Any]:
        """Return counts, percentiles of the ages in ms, and the arrival of the first message.

        ``distinct`` counts every stamp once. ``tail_ms`` is the median age of the last tenth,
        ``took_ms`` the time from the oldest stamp to the last arrival. Start-up is in the counts
        and in ``took_ms`` alone.
        """
        stamps_ns = self._stamps_ns[:]
        ages_ns = self._ages_ns[: len(stamps_ns)]
        result: dict[str, Any] = {"count": len(stamps_ns), "distinct": len(set(stamps_ns))}
        if len(ages_ns) < 2:
            return result
        settled = _settled(ages_ns)
        cuts = statistics.quantiles(settled, n=100)
        result |= {f"p{percent}_ms": cuts[percent - 1] / 1e6 for percent in (50, 90, 99)}
        tail = ages_ns[-max(1, len(ages_ns) // 10) :]
        return result | {
            "max_ms": max(settled) / 1e6,
            "tail_ms": statistics.median(tail) / 1e6,
            "first_ns": stamps_ns[0] + ages_ns[0],
            "took_ms": (stamps_ns[-1] + ages_ns[-1] - min(stamps_ns)) / 1e6,
        }


def _settled(ages_ns: Sequence[int]) -> Sequence[int]:
    """Leave out start-up, if anything is left then."""
    start = len(ages_ns) // 10
    return ages_ns[start:] if len(ages_ns) - start > 1 else ages_ns
