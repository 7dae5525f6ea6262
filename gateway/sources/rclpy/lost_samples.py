# SPDX-License-Identifier: Apache-2.0
"""The number of samples that were published and never reached the gateway."""

from collections.abc import Callable
from typing import Final

NO_NUMBER: Final = 0  # publishers begin with 1


class LostSamples:
    """Counts what one reader has missed, by the numbers that a publisher gives its samples.

    DDS counts samples as lost that did not arrive. It does not count samples that newer ones
    replaced in a full reader. A number does not say whose it is, so DDS alone counts while several
    publish.
    """

    __slots__ = ("_by_dds", "_by_number", "_is_alone", "_on_lost", "_publishers", "_told")

    def __init__(self, publishers: Callable[[], int], on_lost: Callable[[int], None]) -> None:
        """Count from 0.

        Args:
            publishers: Returns how many the reader is matched with.
            on_lost: Takes the number of those that were found to be lost.
        """
        self._publishers = publishers
        self._on_lost = on_lost
        self._is_alone = False  # the one publisher, at the last jump
        self._by_number = 0
        self._by_dds = 0
        self._told = 0  # as an event

    @property
    def total(self) -> int:
        """The samples that were lost so far."""
        return max(self._by_number, self._by_dds)

    def jump(self, expected: int, number: int | None) -> int:
        """Return the number of a sample that has another one than *expected*, and count the gap.

        `NO_NUMBER` stands for those of a middleware that has none, and is expected at first.
        """
        if number is None:
            return NO_NUMBER
        was_alone, self._is_alone = self._is_alone, self._publishers() == 1
        if expected != NO_NUMBER and was_alone and self._is_alone and number > expected:
            self._grow(by_number=number - expected)  # a smaller one: it has begun again
        return number

    def take(self, by_dds: int) -> int:
        """Add what DDS has counted, and return the number since the last call."""
        self._grow(by_dds=by_dds)
        new, self._told = self.total - self._told, self.total
        return new

    def _grow(self, *, by_number: int = 0, by_dds: int = 0) -> None:
        before = self.total
        self._by_number += by_number
        self._by_dds += by_dds
        if self.total != before:
            self._on_lost(self.total - before)
