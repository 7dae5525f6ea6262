# SPDX-License-Identifier: Apache-2.0
"""The samples that a client did not get, next to those that the gateway says it has dropped."""

from dataclasses import dataclass


@dataclass
class Drops:
    """One subscription with ``meta``, over all connections of its client.

    Drops come from the old end of a queue. So by the time of a frame, the gateway has counted at
    least the drops that the client misses by then. It has counted more if samples were dropped
    before the first frame, or while a worker encoded an older one. If it has counted fewer, it
    missed a drop.
    """

    missing: int = 0
    counted: int = 0
    uncounted: int = 0
    _first_seq: int | None = None
    _received: int = 0
    _missing: int = 0
    _counted: int = 0

    def connect(self) -> None:
        """Begin with another subscription."""
        self._first_seq = None

    def add(self, seq: int, dropped: int) -> None:
        """Take the number of a sample, and the drops so far."""
        if self._first_seq is None:
            self._first_seq = seq
            self._received = self._missing = self._counted = 0
        self._received += 1
        missing = seq - self._first_seq + 1 - self._received
        self.missing += missing - self._missing
        self.counted += dropped - self._counted
        self._missing, self._counted = missing, dropped
        self.uncounted = max(self.uncounted, missing - dropped)

    def as_json(self) -> dict[str, int]:
        """Return the counts."""
        return {"missing": self.missing, "counted": self.counted, "uncounted": self.uncounted}
