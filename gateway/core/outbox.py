# SPDX-License-Identifier: Apache-2.0
"""All that waits for one client: control frames, which overtake, and bounded queues.

No entry is encoded before its turn to be sent: a sample that is dropped was never decoded. An entry
that comes while nothing ready waits and the socket has room is written directly.

If the link is too slow for everything, its bytes are shared between small entries (state) and large
ones (pictures, scans, maps). The queues of each kind share their part by start-time fair queueing
(Goyal, Vin and Cheng, 1996). A queue that has less to send than its share does not wait.
"""

import itertools
from collections import deque
from heapq import heappop, heappush
from typing import Final

from gateway.codec.chunks import Chunk
from gateway.core.entries import (
    PacedSocket,
    QueueOwner,
    WriteDirectly,
)
from gateway.core.fair_queueing import Kind, fair_part
from gateway.core.queue import Queue

# Of a link that is too slow for both: a robot is driven by its state, a picture can be smaller.
LARGE_SHARE: Final = 0.2
# Bytes that the link does not drain in this time arrive old, so newer entries replace them.
FRESH_S: Final = 0.05


class Outbox:
    """Everything that waits for one client, within one budget of bytes.

    Over the budget the queue that holds most loses its oldest entry: a camera cannot push out
    odometry. Control frames are never dropped, and one of them always fits, as large as it is: a
    client that reads gets it. `overflowed` says when those behind it alone exceed the budget, and
    then the client is beyond help.
    """

    def __init__(self, max_bytes: int) -> None:
        self.max_bytes = max_bytes
        # of a connection, while it is open
        self.write_directly: WriteDirectly | None = None
        self.socket: PacedSocket | None = None
        self.size = 0
        # something came since all that was ready was taken. Pictures that wait for their encoding
        # keep nobody else waiting
        self.may_have_ready = False
        self.control_sent = 0
        self._control: deque[bytes] = deque()
        self._control_size = 0
        self.bytes_per_s: float | None = None  # of the link, None if it is not too slow
        self._queues: list[Queue] = []
        self.small = Kind(1 - LARGE_SHARE)
        self.large = Kind(LARGE_SHARE)
        self._clock = 0.0  # the start of the kind that was served last
        # of queues that were closed
        self._closed_coalesced = 0
        self._closed_dropped = 0
        self._closed_sent = 0

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
        return self._closed_dropped + sum(queue.dropped for queue in self._queues)

    @property
    def coalesced(self) -> int:
        """The number of samples that a throttle replaced by newer ones."""
        return self._closed_coalesced + sum(queue.coalesced for queue in self._queues)

    @property
    def sent(self) -> int:
        """The number of frames that were taken, control frames included."""
        return self.control_sent + self._closed_sent + sum(queue.sent for queue in self._queues)

    def connect(self, write_directly: WriteDirectly, socket: PacedSocket) -> None:
        """Write past the queues from now on what need not wait."""
        self.write_directly = write_directly
        self.socket = socket

    def disconnect(self) -> None:
        """Write nothing any more but what is taken."""
        self.write_directly = self.socket = None

    def open_queue(
        self, depth: int, max_bytes: int | None, owner: QueueOwner | None = None
    ) -> Queue:
        """Add a queue."""
        queue = Queue(self, depth, max_bytes, owner)
        self._queues.append(queue)
        return queue

    def close_queue(self, queue: Queue) -> None:
        """Remove a queue with all that waits in it."""
        queue.close()
        self._queues.remove(queue)
        self._closed_coalesced += queue.coalesced
        self._closed_dropped += queue.dropped
        self._closed_sent += queue.sent

    def put_control(self, frame: bytes) -> None:
        """Append a response or a status. It overtakes every queue."""
        self._control.append(frame)
        self._control_size += len(frame)
        self.grow(len(frame))
        self.shed()

    def take(self, max_bytes: int) -> list[Chunk]:
        """Take what is ready: control frames first, then frames of the queues by fair shares.

        Stops once *max_bytes* are reached, so it exceeds them by one frame at most. A frame in
        pieces is taken as these.
        """
        taken: list[Chunk] = []
        left = max_bytes
        while self._control and left > 0:
            frame = self._control.popleft()
            self._control_size -= len(frame)
            self.grow(-len(frame))
            self.control_sent += 1
            taken.append(frame)
            left -= len(frame)
        # now, not for each entry that comes: it looks at all queues
        if self.size and self.bytes_per_s is not None:
            self._freshen(self.bytes_per_s * FRESH_S)
        self.may_have_ready = False  # to encode may add a status
        if self.size:
            left = self._take_queued(taken, left)
        self.may_have_ready |= left <= 0
        return taken

    def _take_queued(self, taken: list[Chunk], left: int) -> int:
        """Add frames of the queues, those first that have had least. Each waits in a heap.

        Return how many more bytes could be taken.
        """
        order = itertools.count()
        waiting: dict[Kind, list[tuple[float, int, Queue]]] = {self.small: [], self.large: []}

        def enter(queue: Queue) -> None:
            kind = queue.kind
            heappush(waiting[kind], (kind.start(queue.progress), next(order), queue))

        for queue in self._queues:
            if queue.pending:
                enter(queue)
        while left > 0 and (kinds := [kind for kind, queues in waiting.items() if queues]):
            for kind in kinds:
                kind.catch_up(self._clock)
            kind = min(kinds, key=lambda kind: kind.finish_bytes)
            self._clock = kind.finish_bytes
            start, _, queue = heappop(waiting[kind])
            frame = queue.next()
            size = 0 if frame is None else len(frame)
            kind.serve(queue.progress, start, size)
            if frame is not None:
                taken += [frame] if isinstance(frame, bytes) else frame.parts
                left -= size
                if queue.pending:
                    enter(queue)
        return left

    def drains(self, bytes_per_s: float | None) -> None:
        """Take note of the rate at which the link drains. ``None`` if nobody needs to care."""
        self.bytes_per_s = bytes_per_s

    @property
    def _oldest_control_size(self) -> int:
        return len(self._control[0]) if self._control else 0

    def grow(self, size: int) -> None:
        """Account for bytes that came or, negative, went."""
        self.size += size
        self.may_have_ready |= size > 0

    def shed(self) -> None:
        """Drop until the budget holds, or until one last entry is left to send."""
        if self.size <= self.max_bytes:
            return
        waiting = sum(len(queue.waiting) for queue in self._queues)
        while self.size > self.max_bytes and waiting > 1:
            filled = (queue for queue in self._queues if queue.waiting)
            max(filled, key=lambda queue: queue.size).drop_oldest()
            waiting -= 1

    def _freshen(self, drained_bytes: float) -> None:
        """Drop what the link does not drain in time, except for the newest entry of each queue."""
        for kind in (self.small, self.large):
            queues = [queue for queue in self._queues if queue.waiting and queue.kind is kind]
            most = fair_part([queue.behind_bytes for queue in queues], drained_bytes * kind.share)
            for queue in queues:
                while queue.behind_bytes > most:
                    queue.drop_oldest()
