# SPDX-License-Identifier: Apache-2.0
"""The choice which samples that cannot be encoded the subscribers of a topic are told of."""

from typing import Final

from gateway.protocol.token_bucket import TokenBucket

# A publisher that sends ever new nonsense fills no memory, no log and no screen: its first faults
# are told of at once, of what follows one each 5 s.
MAX_AT_ONCE: Final = 16
PER_S: Final = 0.2
# The same fault is told of again after a minute, as a reminder that it lasts.
REPEAT_NS: Final = 60_000_000_000


class SampleFaults:
    """The faults of a topic's samples, as far as its subscribers know of them."""

    def __init__(self, now_ns: int) -> None:
        self._bucket = TokenBucket(PER_S, MAX_AT_ONCE, now_ns)
        self._told: dict[str, int] = {}  # when, oldest first
        self._untold = 0

    def note(self, text: str, now_ns: int) -> str | None:
        """Return what to tell of a fault, or ``None`` if it only counts."""
        told_ns = self._told.get(text)
        is_known = told_ns is not None and now_ns - told_ns < REPEAT_NS
        if is_known or not self._bucket.allow(now_ns):
            self._untold += 1
            return None
        self._told.pop(text, None)
        self._told[text] = now_ns
        if len(self._told) > MAX_AT_ONCE:
            del self._told[next(iter(self._told))]
        untold, self._untold = self._untold, 0
        return f"{text} ({untold} more since the last warning)" if untold else text

    def forget(self) -> None:
        """Tell of every fault anew, as there is somebody who does not know."""
        self._told.clear()
