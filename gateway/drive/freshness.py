# SPDX-License-Identifier: Apache-2.0
"""The age of a command: by its client's own clock, else by the time that it may have waited here.

A client that sends more than its time budget allows is read slowly. Its commands come late and one
by one, as if it still drove. Without a clock they are as old as the input that waited longest.

The two clocks are independent. The delay between them is the gateway's time of arrival less the
client's time of sending. It is smallest for the command that travelled fastest. Every other command
is older than that one by the difference.
"""

from typing import Final, Literal

MAX_AGE_NS: Final = 250_000_000
# The best delay of a connection grows by 200 ppm, because crystals differ by up to 100 ppm. In the
# ten seconds after which a silent connection ends, it grows by less than `MAX_AGE_NS`.
FORGETTING: Final = 5000
# A program that reconnects may send old commands at once, so the age of the best of the first
# commands of a connection is unknown.
SETTLING_NS: Final = 1_000_000_000

Age = Literal[
    "fresh",  # not older than the best by `MAX_AGE_NS`
    "stale",
    "behind",  # it waited for `MAX_AGE_NS`, because its client has spent its time budget
    "waited",  # as long, for the gateway
    "delayed",  # its relay sent it too long after the gateway's last sign of life
    "unknown",  # no time was given and nothing waited, or the connection is too young to know
]
LATE: Final[frozenset[Age]] = frozenset({"stale", "behind", "waited", "delayed"})


class Freshness:
    """The times of one connection's commands."""

    __slots__ = ("_best_ns", "_first_ns", "_judged_ns")

    def __init__(self) -> None:
        self._first_ns: int | None = None
        self._best_ns = 0
        self._judged_ns = 0

    def judge(
        self, sent_ms: float | None, now_ns: int, waited_ns: int = 0, *, is_behind: bool = False
    ) -> Age:
        """Return the age of a command that was sent at *sent_ms* of the client's clock.

        *waited_ns* is how long it may have waited before the gateway read it, at most.
        """
        if sent_ms is None:
            waited: Age = "behind" if is_behind else "waited"
            return waited if waited_ns >= MAX_AGE_NS else "unknown"
        delay_ns = now_ns - round(sent_ms * 1e6)
        if self._first_ns is None:
            self._first_ns = self._judged_ns = now_ns
            self._best_ns = delay_ns
        grown_ns = self._best_ns + (now_ns - self._judged_ns) // FORGETTING
        self._judged_ns = now_ns
        self._best_ns = min(grown_ns, delay_ns)
        if delay_ns - self._best_ns >= MAX_AGE_NS:
            return "stale"
        return "fresh" if now_ns - self._first_ns >= SETTLING_NS else "unknown"
