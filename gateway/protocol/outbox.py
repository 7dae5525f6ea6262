# SPDX-License-Identifier: Apache-2.0
"""All that waits for one client: control frames, which overtake, and bounded queues.

No entry is encoded before its turn to be sent: a sample that is dropped was never decoded. An entry
that comes while nothing waits and the socket takes has its turn at once; it is written directly.
"""

import enum
from collections import deque
from collections.abc import Callable
from typing import Final, Literal, Protocol, TypeAlias

from gateway.codec.pieces import Piece, Pieces


class NoFrame(enum.Enum):
    """Why an entry has no frame to send."""

    NOT_READY = "not ready"  # a worker encodes it: ask again when the session is woken
    NOTHING = "nothing"  # it cannot be encoded, and never will be


NOT_READY: Final[Literal[NoFrame.NOT_READY]] = NoFrame.NOT_READY
NOTHING: Final[Literal[NoFrame.NOTHING]] = NoFrame.NOTHING

Frame: TypeAlias = bytes | Pieces | Literal[NoFrame.NOT_READY, NoFrame.NOTHING]


class Entry(Protocol):
    """Something to be sent, encoded when its turn has come."""

    @property
    def size(self) -> int:
        """The bytes that this entry keeps alive while it waits."""

    @property
    def is_being_encoded(self) -> bool:
        """True while a worker encodes it: it must not be dropped any more."""

    @property
    def arrived_ns(self) -> int:
        """The time at which DDS had it, by the system clock; 0 if it did not just come from DDS."""

    def frame(self) -> Frame:
        """Return the bytes to send, WebSocket header included, or why there are none."""


WriteDirectly = Callable[[Entry], int]
"""Write an entry to the socket; return its bytes, 0 if it is not ready or the socket is busy."""

OnTimed = Callable[[int], None]
"""Take the time at which an entry arrived that was just handed to the socket."""

# Of so many entries of a queue that have waited, one is timed when it is sent.
TIMED_EVERY: Final = 16


class Queue:
    """The entries of one subscription that wait, oldest first; the oldest is dropped when full.

    ``depth`` bounds their number and ``max_bytes`` their size, but one entry always fits.
    """

    __slots__ = (
        "_outbox",
        "claimed",
        "coalesced",
        "depth",
        "discarded",
        "dropped",
        "max_bytes",
        "on_timed",
        "sent",
        "sent_bytes",
        "size",
        "waiting",
    )

    def __init__(self, outbox: "Outbox", depth: int, max_bytes: int | None) -> None:
        self._outbox = outbox
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
        self.on_timed: OnTimed | None = None  # gets one in `TIMED_EVERY` of what has waited

    @property
    def pending(self) -> int:
        """The number of entries that wait."""
        return len(self.waiting) + (self.claimed is not None)

    def put(self, entry: Entry, *, more: bool = False) -> None:
        """Write an entry directly if possible, else append it and drop what does not fit.

        *more* says that others follow at once, to be written together.
        """
        outbox = self._outbox
        write_directly = outbox.write_directly
        if write_directly is not None and not (more or outbox.size):
            written = write_directly(entry)
            if written:
                self.sent += 1
                self.sent_bytes += written
                return
        self.waiting.append(entry)
        self.size += entry.size
        outbox.grow(entry.size)
        while len(self.waiting) > self.depth or (
            self.max_bytes is not None and self.size > self.max_bytes and len(self.waiting) > 1
        ):
            self.drop_oldest()
        outbox.shed()

    def drop_oldest(self) -> None:
        """Drop the entry that has waited longest, and count it."""
        self._forget(self.waiting.popleft())
        self.dropped += 1

    def next(self) -> bytes | Pieces | None:
        """Take the oldest entry's frame; ``None`` if no entry is ready."""
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
                if not self.sent % TIMED_EVERY and self.on_timed is not None:
                    self.on_timed(entry.arrived_ns)
                return frame
            self.discarded += 1
        return None

    def clear(self) -> None:
        """Forget everything that waits: nobody wants it any more."""
        self.discarded += self.pending
        self._outbox.grow(-self.size)
        self.size = 0
        self.waiting.clear()
        self.claimed = None

    def _forget(self, entry: Entry) -> None:
        self.size -= entry.size
        self._outbox.grow(-entry.size)


class Outbox:
    """Everything that waits for one client, within one budget of bytes.

    Over the budget the queue that holds most loses its oldest entry: a camera cannot push out
    odometry. Control frames are never dropped, and one of them always fits, as large as it is: a
    client that reads gets it. `overflowed` says when those behind it alone exceed the budget, and
    then the client is beyond help.
    """

    def __init__(self, max_bytes: int) -> None:
        self.max_bytes = max_bytes
        self.write_directly: WriteDirectly | None = None  # of a connection, once there is one
        self.size = 0
        self.control_sent = 0
        self._control: deque[bytes] = deque()
        self._control_size = 0
        self._queues: deque[Queue] = deque()  # the first is served next
        # of queues that were closed
        self._past_coalesced = 0
        self._past_dropped = 0
        self._past_sent = 0

    @property
    def overflowed(self) -> bool:
        """True when control frames alone exceed the budget, the oldest aside."""
        return self._control_size - self._oldest_control_size > self.max_bytes

    @property
    def excess(self) -> int:
        """The bytes that wait, the oldest control frame aside."""
        return self.size - self._oldest_control_size

    @property
    def has_control(self) -> bool:
        """True while a control frame waits."""
        return bool(self._control)

    @property
    def dropped(self) -> int:
        """The number of entries that were dropped, in all queues there ever were."""
        return self._past_dropped + sum(queue.dropped for queue in self._queues)

    @property
    def coalesced(self) -> int:
        """The number of samples that a throttle replaced by newer ones."""
        return self._past_coalesced + sum(queue.coalesced for queue in self._queues)

    @property
    def sent(self) -> int:
        """The number of frames that were taken, control frames included."""
        return self.control_sent + self._past_sent + sum(queue.sent for queue in self._queues)

    def open_queue(self, depth: int, max_bytes: int | None) -> Queue:
        """Add a queue."""
        queue = Queue(self, depth, max_bytes)
        self._queues.append(queue)
        return queue

    def close_queue(self, queue: Queue) -> None:
        """Remove a queue with all that waits in it."""
        queue.clear()
        self._queues.remove(queue)
        self._past_coalesced += queue.coalesced
        self._past_dropped += queue.dropped
        self._past_sent += queue.sent

    def put_control(self, frame: bytes) -> None:
        """Append a response or a status; it overtakes every queue."""
        self._control.append(frame)
        self._control_size += len(frame)
        self.grow(len(frame))
        self.shed()

    def take(self, max_bytes: int) -> list[Piece]:
        """Take what is ready: control frames first, then one frame per queue in turn.

        Stops once *max_bytes* are reached, so it exceeds them by one frame at most. A frame in
        pieces is taken as these.
        """
        taken: list[Piece] = []
        left = max_bytes
        while self._control and left > 0:
            frame = self._control.popleft()
            self._control_size -= len(frame)
            self.grow(-len(frame))
            self.control_sent += 1
            taken.append(frame)
            left -= len(frame)
        queues = self._queues if self.size else ()
        idle = 0
        while left > 0 and idle < len(queues):
            ready = self._queues[0].next()
            self._queues.rotate(-1)
            if ready is None:
                idle += 1
            else:
                idle = 0
                if isinstance(ready, bytes):
                    taken.append(ready)
                else:
                    taken += ready.parts
                left -= len(ready)
        return taken

    @property
    def _oldest_control_size(self) -> int:
        return len(self._control[0]) if self._control else 0

    def grow(self, size: int) -> None:
        """Account for bytes that came or, negative, went."""
        self.size += size

    def shed(self) -> None:
        """Drop until the budget holds, or until one last entry is left to send."""
        if self.size <= self.max_bytes:
            return
        waiting = sum(len(queue.waiting) for queue in self._queues)
        while self.size > self.max_bytes and waiting > 1:
            filled = (queue for queue in self._queues if queue.waiting)
            max(filled, key=lambda queue: queue.size).drop_oldest()
            waiting -= 1
