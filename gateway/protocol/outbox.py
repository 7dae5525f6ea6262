# SPDX-License-Identifier: Apache-2.0
"""What waits for one client: a control queue that overtakes, and a bounded queue per topic.

Nothing here is rendered before its turn to be sent: a sample that is dropped was never decoded.
What comes while nothing waits and the socket takes has its turn at once, and passes by the queues.
"""

from collections import deque
from collections.abc import Callable
from typing import Protocol


class Entry(Protocol):
    """Something that can be put on the wire, now or soon."""

    @property
    def size(self) -> int:
        """The bytes that this entry keeps alive while it waits."""

    @property
    def is_being_rendered(self) -> bool:
        """Whether work on it is under way, so that it must not be dropped any more."""

    def wire(self) -> bytes | None:
        """Return the bytes to send; ``None``: not ready yet; empty: nothing to send after all."""


WriteDirectly = Callable[[Entry], bool]
"""Write an entry to the socket; false where it is not ready, or where the socket is busy."""


class Queue:
    """The entries of one stream that wait, oldest first; the oldest is dropped when full.

    ``depth`` bounds their number and ``max_bytes`` their size, but one entry always fits.
    """

    __slots__ = ("_outbox", "claimed", "depth", "dropped", "max_bytes", "sent", "size", "waiting")

    def __init__(self, outbox: "Outbox", depth: int, max_bytes: int | None) -> None:
        self._outbox = outbox
        self.depth = depth
        self.max_bytes = max_bytes
        self.waiting: deque[Entry] = deque()
        self.claimed: Entry | None = None  # its turn has come, but it is still being rendered
        self.size = 0
        self.sent = 0
        self.dropped = 0

    def put(self, entry: Entry, *, more: bool = False) -> None:
        """Send an entry where it can go at once, else append it and drop what does not fit.

        *more* says that others follow at once, to be written together.
        """
        outbox = self._outbox
        if (
            outbox.write_directly is not None
            and not (more or outbox.size)
            and outbox.write_directly(entry)
        ):
            self.sent += 1
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

    def next(self) -> bytes | None:
        """Take the oldest entry's bytes, or ``None`` where nothing is ready."""
        while self.claimed is not None or self.waiting:
            entry = self.claimed if self.claimed is not None else self.waiting[0]
            wire = entry.wire()
            # What nobody works on yet stays droppable: when its turn comes, a newer one may wait.
            if self.claimed is None and (wire is not None or entry.is_being_rendered):
                self.claimed = self.waiting.popleft()
            if wire is None:
                return None
            self._forget(entry)
            self.claimed = None
            if wire:
                self.sent += 1
                return wire
        return None

    def clear(self) -> None:
        """Forget everything that waits, uncounted: nobody wants it any more."""
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
        self._retired_dropped = 0
        self._retired_sent = 0

    @property
    def overflowed(self) -> bool:
        """Whether control frames alone exceed the budget, the oldest aside."""
        return self._control_size - self._oldest_control_size > self.max_bytes

    @property
    def excess(self) -> int:
        """The bytes that wait, the oldest control frame aside."""
        return self.size - self._oldest_control_size

    @property
    def has_control(self) -> bool:
        """Whether a control frame waits."""
        return bool(self._control)

    @property
    def dropped(self) -> int:
        """How many entries were dropped, in all queues there ever were."""
        return self._retired_dropped + sum(queue.dropped for queue in self._queues)

    @property
    def sent(self) -> int:
        """How many frames were taken, control frames included."""
        return self.control_sent + self._retired_sent + sum(queue.sent for queue in self._queues)

    def open_queue(self, depth: int, max_bytes: int | None) -> Queue:
        """Add a queue for one stream."""
        queue = Queue(self, depth, max_bytes)
        self._queues.append(queue)
        return queue

    def close_queue(self, queue: Queue) -> None:
        """Remove a queue with all that waits in it."""
        queue.clear()
        self._queues.remove(queue)
        self._retired_dropped += queue.dropped
        self._retired_sent += queue.sent

    def put_control(self, wire: bytes) -> None:
        """Append a response or a status; it overtakes every queue."""
        self._control.append(wire)
        self._control_size += len(wire)
        self.grow(len(wire))
        self.shed()

    def take(self, max_bytes: int) -> list[bytes]:
        """Take what is ready: control frames first, then one frame per queue in turn.

        Stops once *max_bytes* are reached, so it exceeds them by one frame at most.
        """
        taken: list[bytes] = []
        left = max_bytes
        while self._control and left > 0:
            wire = self._control.popleft()
            self._control_size -= len(wire)
            self.grow(-len(wire))
            self.control_sent += 1
            taken.append(wire)
            left -= len(wire)
        queues = self._queues if self.size else ()
        idle = 0
        while left > 0 and idle < len(queues):
            ready = self._queues[0].next()
            self._queues.rotate(-1)
            if ready is None:
                idle += 1
            else:
                idle = 0
                taken.append(ready)
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
