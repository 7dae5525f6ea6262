# SPDX-License-Identifier: Apache-2.0
"""What a transient-local topic keeps for clients that come later."""

from collections import deque
from collections.abc import Sequence
from typing import Final

from gateway.ports import Sample

# Two maps of a large building; of bigger messages the newest one alone is kept.
MAX_BYTES: Final = 8 * 1024**2


class Latch:
    """The newest samples of a topic with their numbers, within `MAX_BYTES`; one always fits."""

    def __init__(self) -> None:
        self._kept: deque[tuple[int, Sample]] = deque()
        self._size = 0

    def keep(self, samples: Sequence[Sample], first_seq: int, count: int) -> None:
        """Add samples, the first of which has number *first_seq*; keep *count* in all."""
        for seq, sample in enumerate(samples, start=first_seq):
            self._kept.append((seq, sample))
            self._size += len(sample.cdr)
        while len(self._kept) > count or (self._size > MAX_BYTES and len(self._kept) > 1):
            _, dropped = self._kept.popleft()
            self._size -= len(dropped.cdr)

    def newest(self, count: int) -> list[tuple[int, Sample]]:
        """Return the newest samples with their numbers, oldest first."""
        return list(self._kept)[-count:]

    def clear(self) -> None:
        """Forget all: the topic keeps nothing any more."""
        self._kept.clear()
        self._size = 0
