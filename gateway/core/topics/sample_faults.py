# SPDX-License-Identifier: Apache-2.0
"""The choice which samples that cannot be encoded are reported to the subscribers of a topic."""

from typing import Final

from gateway.core.token_bucket import TokenBucket

# A publisher that sends ever new nonsense fills no memory, no log and no screen: its first faults
# are reported at once, of what follows one each 5 s.
MAX_AT_ONCE: Final = 16
PER_S: Final = 0.2
# The same fault is reported again after a minute, as a reminder that it lasts.
REPEAT_NS: Final = 60_000_000_000


class SampleFaults:
    """The faults of a topic's samples, as far as its subscribers know of them."""

    def __init__(self, now_ns: int) -> None:
        self._bucket = TokenBucket(PER_S, MAX_AT_ONCE, now_ns)
        self._reported: dict[str, int] = {}  # when, oldest first
        self._unreported = 0

    def note(self, text: str, now_ns: int) -> str | None:
        """Return the text to report a fault with, or ``None`` if it only counts."""
        reported_ns = self._reported.get(text)
        is_known = reported_ns is not None and now_ns - reported_ns < REPEAT_NS
        if is_known or not self._bucket.allow(now_ns):
            self._unreported += 1
            return None
        self._reported.pop(text, None)
        self._reported[text] = now_ns
        if len(self._reported) > MAX_AT_ONCE:
            del self._reported[next(iter(self._reported))]
        unreported, self._unreported = self._unreported, 0
        return f"{text} ({unreported} more since the last warning)" if unreported else text

    def forget(self) -> None:
        """Report every fault again, because there is a new subscriber."""
        self._reported.clear()
