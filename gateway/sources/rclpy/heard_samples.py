# SPDX-License-Identifier: Apache-2.0
"""The samples of one subscription whose reader is replaced: each once, in the publisher's order."""

from collections.abc import Sequence
from typing import Final

from gateway.sources.source import Sample

# One that publishes once and ends has a new id each time. Beyond these, the oldest is forgotten:
# it may be heard twice.
MAX_PUBLISHERS: Final = 1024
# A map of a large building. They wait for some milliseconds, until the new reader has more.
MAX_HELD_BYTES: Final = 8 * 1024**2


class HeardSamples:
    """Compares what two readers of one topic take, by publisher and number.

    A middleware that has no ids of publishers gets all of it delivered.
    """

    def __init__(self) -> None:
        self._newest: dict[bytes, int] = {}
        self._began: frozenset[bytes] = frozenset()  # publishers before the reader in force
        self._held: list[Sample] = []
        self._held_bytes = 0

    def begin(self) -> None:
        """Note that a new reader comes into force."""
        self._began = frozenset(self._newest)

    def new(self, samples: Sequence[Sample]) -> list[Sample]:
        """Return those of the reader in force that nobody has delivered, after what they follow."""
        new: list[Sample] = []
        for sample in samples:
            if self._held:
                self._release(new, before=sample)
            self._append(new, sample)
        return new

    def hold(self, samples: Sequence[Sample]) -> list[Sample]:
        """Return those of a retired reader that can be delivered now.

        The first ones of a publisher wait: the reader in force gets earlier ones that it retains.
        """
        new: list[Sample] = []
        for sample in samples:
            if sample.publisher is None or sample.publisher in self._began:
                self._append(new, sample)
                continue
            self._held.append(sample)
            self._held_bytes += len(sample.cdr)
        return new + self.release() if self._held_bytes > MAX_HELD_BYTES else new

    def release(self) -> list[Sample]:
        """Return all that waits."""
        new: list[Sample] = []
        self._release(new)
        return new

    def forget(self) -> None:
        """Forget the publishers: nothing of theirs comes again."""
        self._newest.clear()

    def _release(self, new: list[Sample], before: Sample | None = None) -> None:
        """Append what waits, or what of it comes before another sample of its publisher."""
        held, self._held, self._held_bytes = self._held, [], 0
        for sample in held:
            is_later = before is not None and _mark(sample) >= _mark(before)
            if before is not None and (sample.publisher != before.publisher or is_later):
                self._held.append(sample)
                self._held_bytes += len(sample.cdr)
            else:
                self._append(new, sample)

    def _append(self, new: list[Sample], sample: Sample) -> None:
        publisher, mark = sample.publisher, _mark(sample)
        if publisher is not None:
            known = self._newest.get(publisher)
            if known is not None and mark <= known:
                return
            self._newest[publisher] = mark
            if known is None and len(self._newest) > MAX_PUBLISHERS:
                del self._newest[next(iter(self._newest))]
        new.append(sample)


def _mark(sample: Sample) -> int:
    return sample.source_ns if sample.number is None else sample.number
