# SPDX-License-Identifier: Apache-2.0
"""Gaps, repetitions and disorder in numbers that a publisher counts up.

A number carries the epoch of its publisher above its own bits: a publisher that returns after
it was killed begins a new epoch at 0. Only within an epoch, and within a connection, must each
number follow the one before.
"""

from dataclasses import dataclass, field
from typing import Any

from tests.soak.load import NUMBER_BITS


@dataclass
class Sequence:
    """The faults so far."""

    received: int = 0
    epochs: int = 0
    missing: int = 0
    repeated: int = 0
    disordered: int = 0
    spans: dict[int, tuple[int, int]] = field(default_factory=dict)
    """The first and the last number of each epoch."""
    _last: int | None = None

    def connect(self) -> None:
        """Begin with any number."""
        self._last = None

    def add(self, value: int) -> None:
        """Take the next number as it was received."""
        self.received += 1
        epoch, number = divmod(value, 1 << NUMBER_BITS)
        first, last_so_far = self.spans.get(epoch, (number, number))
        self.spans[epoch] = min(first, number), max(last_so_far, number)
        last, self._last = self._last, value
        if last is None or value >> NUMBER_BITS > last >> NUMBER_BITS:
            self.epochs += 1
        elif value == last:
            self.repeated += 1
        elif value < last:
            self.disordered += 1
            self._last = last
        else:
            self.missing += value - last - 1

    def as_json(self) -> dict[str, Any]:
        """Return the counts."""
        return {
            "received": self.received,
            "epochs": self.epochs,
            "missing": self.missing,
            "repeated": self.repeated,
            "disordered": self.disordered,
            "spans": self.spans,
        }
