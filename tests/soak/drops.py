# SPDX-License-Identifier: Apache-2.0
"""The samples that a client did not get, beside those that the gateway says it has dropped."""

from dataclasses import dataclass


@dataclass
class Drops:
    """One subscription with ``meta``, over all connections of its client.

    Drops come from the old end of a queue, so those that the gateway has counted by the time of a
    frame are at least those that the client misses by then. A sample too few there is a drop
    that nobody counted.
    """

    missing: int = 0
    counted: int = 0
    uncounted: int = 0
    _first: tuple[int, int] | None = None
    _received: int = 0
    _missing: int = 0
    _counted: int = 0

    def connect(self) -> None:
        """Begin with another subscription."""
        self._first = None

    def add(self, seq: int, dropped: int) -> None:
        """Take the number of a sample, and the drops so far."""
        if self._first is None:
            self._first = seq, dropped
            self._received = self._missing = self._counted = 0
            return
        self._received += 1
        first_seq, first_dropped = self._first
        missing = seq - first_seq - self._received
        counted = dropped - first_dropped
        self.missing += missing - self._missing
        self.counted += counted - self._counted
        self._missing, self._counted = missing, counted
        self.uncounted = max(self.uncounted, missing - counted)

    def as_json(self) -> dict[str, int]:
        """Return the counts."""
        return {"missing": self.missing, "counted": self.counted, "uncounted": self.uncounted}
