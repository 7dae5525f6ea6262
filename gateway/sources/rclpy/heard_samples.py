# SPDX-License-Identifier: Apache-2.0
"""The samples of one subscription whose reader is replaced: each once, in the publisher's order."""

from collections.abc import Callable, Sequence
from typing import Final

from gateway.sources.source import Sample

# One that publishes once and ends has a new id each time. Beyond these, the oldest is forgotten:
# it may be heard twice.
MAX_PUBLISHERS: Final = 1024
# A map of a large building. They wait for some milliseconds, until the other reader has more.
MAX_HELD_BYTES: Final = 8 * 1024**2


class HeardSamples:
    """Compares what two readers of one topic take, by publisher and number.

    A middleware that has no ids of publishers gets all of it delivered.
    """

    def __init__(self) -> None:
        self._newest: dict[bytes, int] = {}
        # the publishers before the reader in force, if that gets what others retain
        self._retained_after: frozenset[bytes] | None = None
        self._repaired: frozenset[bytes] = frozenset()
        self._held: list[Sample] = []
        self._held_bytes = 0

    def begin(self, *, is_latched: bool, repaired: frozenset[bytes]) -> None:
        """Note that a new reader comes into force, and the one before it retires.

        Args:
            is_latched: The new reader gets what publishers retain.
            repaired: The publishers from which the retired one gets every sample, late if need be.
        """
        known = frozenset(self._newest)
        self._retained_after = known if is_latched else None
        # of two readers only one waits for the other
        self._repaired = repaired & known if is_latched else repaired

    def end(self) -> list[Sample]:
        """Note that the retired reader gets no more. Return all that waits."""
        self._repaired = frozenset()
        return self._release_all()

    def new(self, samples: Sequence[Sample]) -> list[Sample]:
        """Return those of the reader in force that nobody has delivered, after what they follow.

        Those after a gap wait if the retired reader is to get what is missing.
        """
        return self._pass(samples, self._leaves_gap)

    def retired(self, samples: Sequence[Sample]) -> list[Sample]:
        """Return those of a retired reader that can be delivered now.

        The first ones of a publisher wait if the reader in force gets earlier ones from it.
        """
        return self._pass(samples, self._follows_retained)

    def _pass(self, samples: Sequence[Sample], waits: Callable[[Sample], bool]) -> list[Sample]:
        new: list[Sample] = []
        for sample in samples:
            if waits(sample):
                self._hold(sample)
                continue
            if self._held:
                self._release(new, before=sample)
            self._append(new, sample)
        return new + self._release_all() if self._held_bytes > MAX_HELD_BYTES else new

    def _leaves_gap(self, sample: Sample) -> bool:
        publisher = sample.publisher
        if publisher is None or publisher not in self._repaired or sample.number is None:
            return False
        return sample.number > self._newest.get(publisher, 0) + 1

    def _follows_retained(self, sample: Sample) -> bool:
        known = self._retained_after
        return known is not None and sample.publisher is not None and sample.publisher not in known

    def _hold(self, sample: Sample) -> None:
        self._held.append(sample)
        self._held_bytes += len(sample.cdr)

    def _release_all(self) -> list[Sample]:
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
                self._hold(sample)
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
