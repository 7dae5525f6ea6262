# SPDX-License-Identifier: Apache-2.0
"""The pace of a throttled subscription."""

from gateway.protocol.outbox import Entry


class Throttle:
    """Lets at most one entry pass per interval, and always the newest.

    The first passes at once. What comes before its interval is over is held, the newest only, and
    passes at the end of it; so the last entry of all passes, too.
    """

    __slots__ = ("_held", "_interval_ns", "due_ns")

    def __init__(self, interval_ns: int) -> None:
        self._interval_ns = interval_ns
        self._held: Entry | None = None
        self.due_ns = 0  # when the next entry may pass

    @property
    def is_holding(self) -> bool:
        """True while an entry waits for the end of the interval."""
        return self._held is not None

    def passes(self, entry: Entry, now_ns: int) -> bool:
        """Return whether an entry passes now; else hold it until `due_ns`, for `release`."""
        if self._held is None and now_ns >= self.due_ns:
            self._keep_the_beat(now_ns)
            return True
        self._held = entry
        return False

    def release(self, now_ns: int) -> Entry | None:
        """Return the entry that was held, at the end of its interval."""
        held, self._held = self._held, None
        if held is not None:
            self._keep_the_beat(now_ns)
        return held

    def clear(self) -> None:
        """Forget the entry that is held."""
        self._held = None

    def _keep_the_beat(self, now_ns: int) -> None:
        # While entries come in time the beat goes on, however late a timer is; after a pause a
        # new one begins.
        is_in_time = now_ns - self.due_ns < self._interval_ns
        self.due_ns = (self.due_ns if is_in_time else now_ns) + self._interval_ns
