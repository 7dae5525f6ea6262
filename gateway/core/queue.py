# SPDX-License-Identifier: Apache-2.0
"""The entries that wait in one queue of a client, and those that it drops."""

from collections import deque
from typing import Final, Protocol

from gateway.codec.chunks import Chunks
from gateway.core.entries import NOT_READY, NOTHING, Entry, QueueOwner, WriteDirectly
from gateway.core.fair_queueing import Kind, Progress

# Of so many entries of a queue that have waited, one is timed when it is sent.
TIMED_EVERY: Final = 16

# Odometry with its covariances is smaller, a scan of 1,000 rays larger.
LARGE_FRAME_BYTES: Final = 4096


class QueueGroup(Protocol):
    """The queues of a client, which share its link and one budget of bytes."""

    write_directly: WriteDirectly | None
    may_have_ready: bool
    small: Kind
    large: Kind

    def grow(self, size: int) -> None:
        """Account for bytes that came or, negative, went."""

    def shed(self) -> None:
        """Drop until the budget holds."""


class Queue:
    """Entries that wait, oldest first, for example of a subscription. If full, drops the oldest.

    ``depth`` bounds their number and ``max_bytes`` their size, but one entry always fits.
    """

    __slots__ = (
        "_group",
        "claimed",
        "coalesced",
        "depth",
        "discarded",
        "dropped",
        "max_bytes",
        "owner",
        "progress",
        "sent",
        "sent_bytes",
        "size",
        "waiting",
    )

    def __init__(
        self, group: QueueGroup, depth: int, max_bytes: int | None, owner: QueueOwner | None
    ) -> None:
        self._group = group
        self.owner = owner  # until it is closed
        self.depth = depth
        self.max_bytes = max_bytes
        self.waiting: deque[Entry] = deque()
        self.claimed: Entry | None = None  # its turn has come, but it is still being encoded
        self.size = 0
        self.sent = 0
        self.sent_bytes = 0
        self.dropped = 0
        self.discarded = 0  # could not be encoded, or nobody wanted them any more
        self.coalesced = 0  # never came here: a throttle let a newer one pass in their place
        self.progress = Progress()

    @property
    def pending(self) -> int:
        """The number of entries that wait."""
        return len(self.waiting) + (self.claimed is not None)

    @property
    def kind(self) -> Kind:
        """The queues that it shares the link with, by its next entry. There must be one."""
        entry = self.waiting[0] if self.claimed is None else self.claimed
        return self._group.large if entry.size > LARGE_FRAME_BYTES else self._group.small

    @property
    def behind_bytes(self) -> float:
        """About what the link has to drain before the newest entry, if older ones may be dropped.

        They may unless the client has asked for a length, or its topic is latched.
        """
        behind = len(self.waiting) - 1
        if behind <= 0 or self.max_bytes is None:
            return 0.0
        if self.owner is not None and self.owner.is_latched():
            return 0.0
        # frames are longer than what they are made of
        return behind * (self.sent_bytes / self.sent if self.sent else self.waiting[0].size)

    def put(self, entry: Entry, *, more: bool = False) -> bool:
        """Write an entry directly if possible, else append it and drop what does not fit.

        *more* says that others follow at once, to be written together. Return whether the client
        has to be woken, for what waits.
        """
        group = self._group
        write_directly = group.write_directly
        if write_directly is not None and not (more or group.may_have_ready or self.size):
            written = write_directly(entry)
            if written:
                self.sent += 1
                self.sent_bytes += written
                return False
        self.waiting.append(entry)
        self.size += entry.size
        group.grow(entry.size)
        while len(self.waiting) > self.depth or (
            self.max_bytes is not None and self.size > self.max_bytes and len(self.waiting) > 1
        ):
            self.drop_oldest()
        group.shed()
        return True

    def drop_oldest(self) -> None:
        """Drop the entry that has waited longest, and count it."""
        self._forget(self.waiting.popleft())
        self.dropped += 1

    def next(self) -> bytes | Chunks | None:
        """Take the oldest entry's frame. ``None`` if no entry is ready."""
        while self.claimed is not None or self.waiting:
            entry = self.claimed if self.claimed is not None else self.waiting[0]
            frame = entry.frame()
            # An entry that nobody encodes yet can still be dropped for a newer one.
            if self.claimed is None and (frame is not NOT_READY or entry.is_being_encoded):
                self.claimed = self.waiting.popleft()
            if frame is NOT_READY:
                return None
            self._forget(entry)
            self.claimed = None
            if frame is not NOTHING:
                self.sent += 1
                self.sent_bytes += len(frame)
                if self.owner is not None:
                    self.owner.has_sent(len(frame))
                    if not self.sent % TIMED_EVERY:
                        self.owner.has_timed(entry.arrived_ns)
                return frame
            self.discarded += 1
        return None

    def bound(self, depth: int, max_bytes: int | None) -> None:
        """Use other bounds for what comes from now on."""
        self.depth, self.max_bytes = depth, max_bytes

    def coalesce(self, count: int) -> None:
        """Count samples that a throttle has replaced by newer ones."""
        self.coalesced += count

    def clear(self, others: int = 0) -> None:
        """Forget everything that waits, and *others* elsewhere: nobody wants it any more."""
        self.discarded += self.pending + others
        self._group.grow(-self.size)
        self.size = 0
        self.waiting.clear()
        self.claimed = None

    def close(self) -> None:
        """Forget everything, and the owner: nothing comes any more."""
        self.clear()
        self.owner = None

    def _forget(self, entry: Entry) -> None:
        self.size -= entry.size
        self._group.grow(-entry.size)
