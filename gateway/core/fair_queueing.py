# SPDX-License-Identifier: Apache-2.0
"""Start-time fair queueing, in two levels: kinds share the link, and queues their kind's part."""

from collections.abc import Sequence
from math import inf


class Progress:
    """The end of the bytes that a queue has sent, by the clock of the kind of its last entry."""

    __slots__ = ("finish_bytes", "kind")

    def __init__(self) -> None:
        self.finish_bytes = 0.0
        self.kind: Kind | None = None


class Kind:
    """Queues whose next entry is small, or large. They share their part of the link equally."""

    __slots__ = ("_clock", "finish_bytes", "share")

    def __init__(self, share: float) -> None:
        self.share = share
        self.finish_bytes = 0.0  # of the whole link, by the clock of the outbox
        self._clock = 0.0  # the start of the queue that was served last

    def catch_up(self, clock: float) -> None:
        """Go on from *clock* at the earliest: a kind that had nothing to send is owed nothing."""
        self.finish_bytes = max(self.finish_bytes, clock)

    def start(self, queue: Progress) -> float:
        """Return where a queue goes on. For a time with nothing of this kind it is owed nothing."""
        return max(queue.finish_bytes, self._clock) if queue.kind is self else self._clock

    def serve(self, queue: Progress, start: float, size: int) -> None:
        """Count a frame that was taken from a queue."""
        self._clock = max(self._clock, start)
        queue.finish_bytes, queue.kind = start + size, self
        self.finish_bytes += size / self.share


def fair_part(wanted: Sequence[float], room: float) -> float:
    """Return what each may have at most, so that all together have no more than the room."""
    for taken, least in enumerate(sorted(wanted)):
        part = room / (len(wanted) - taken)
        if least > part:
            return part
        room -= least
    return inf
