# SPDX-License-Identifier: Apache-2.0
"""The way from Zenoh's threads to the event loop: a queue for each reader, and one eventfd.

All queues together hold a limited number of bytes, and each a limited number of samples. The
oldest samples of a full queue make room for newer ones.
"""

import asyncio
import os
import threading
from collections import deque
from collections.abc import Callable, Sequence
from typing import Final, NamedTuple

from gateway.sources.source import MAX_TAKES_PER_TURN

# The loop is busy for 250 ms at most, in which a robot may send ten large clouds or maps.
MAX_WAITING_BYTES: Final = 64 * 1024**2


class Arrival(NamedTuple):
    """A sample as Zenoh delivers it."""

    cdr: bytes
    attachment: bytes
    received_ns: int
    key: str


class Arrivals:
    """The samples of one reader that wait for the loop."""

    def __init__(self, depth: int, on_arrivals: Callable[[Sequence[Arrival]], None]) -> None:
        self.depth = depth
        self.on_arrivals = on_arrivals
        self.waiting: deque[Arrival] = deque()
        self.is_listed = False  # among those that the loop looks at
        self.is_closed = False

    def close(self) -> None:
        """Deliver nothing any more."""
        self.is_closed = True


class Inbox:
    """The queues of one session. Close it after its session: what comes then is for nobody."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._lock = threading.Lock()
        self._listed: deque[Arrivals] = deque()
        self._waiting_bytes = 0
        self.waker = LoopWaker(loop, self._deliver)

    def put(self, arrivals: Arrivals, new: Arrival) -> None:
        """Add a sample, on any thread."""
        size = len(new.cdr)
        waiting = arrivals.waiting
        with self._lock:
            while waiting and (len(waiting) >= arrivals.depth or not self._has_room(size)):
                self._waiting_bytes -= len(waiting.popleft().cdr)
            # One sample is always let in: a limit of the robot's choice has no right size.
            if arrivals.is_closed or (self._waiting_bytes and not self._has_room(size)):
                return  # its number is missing, and so it counts as lost
            waiting.append(new)
            self._waiting_bytes += size
            if not arrivals.is_listed:
                arrivals.is_listed = True
                self._listed.append(arrivals)
        self.waker.wake()

    def flush(self, arrivals: Arrivals) -> None:
        """Deliver now all that waits for one reader, and as many turns of the others."""
        for _ in range(-(-len(arrivals.waiting) // MAX_TAKES_PER_TURN)):
            self._deliver()

    def close(self) -> None:
        """Wake nobody any more."""
        self.waker.close()

    def _has_room(self, size: int) -> bool:
        return self._waiting_bytes + size <= MAX_WAITING_BYTES

    def _deliver(self) -> None:
        """Deliver some samples of each reader, and let the loop do other work before the next."""
        try:
            for _ in range(len(self._listed)):
                arrivals, taken = self._take()
                if taken and not arrivals.is_closed:
                    arrivals.on_arrivals(taken)
        finally:  # one reader that fails delays none of the others
            if self._listed:
                self.waker.wake()

    def _take(self) -> tuple[Arrivals, list[Arrival]]:
        with self._lock:
            arrivals = self._listed.popleft()
            waiting = arrivals.waiting
            count = min(len(waiting), MAX_TAKES_PER_TURN)
            taken = [waiting.popleft() for _ in range(count)]
            self._waiting_bytes -= sum(len(each.cdr) for each in taken)
            arrivals.is_listed = bool(waiting)
            if waiting:
                self._listed.append(arrivals)
        return arrivals, taken


class LoopWaker:
    """Calls *on_wake* on the loop's thread soon after any thread has called `wake`."""

    def __init__(self, loop: asyncio.AbstractEventLoop, on_wake: Callable[[], None]) -> None:
        self._loop = loop
        self._on_wake = on_wake
        self._is_set = False
        self._is_closed = False
        # Between a test and a write, `close` would let the descriptor become another file's. Zenoh
        # may call `wake` from within another call, where the collector of Python runs.
        self._lock = threading.RLock()
        self._fd: int | None = None
        if hasattr(os, "eventfd"):  # on Linux
            self._fd = os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)
            loop.add_reader(self._fd, self._read)

    def wake(self) -> None:
        """Have the loop call, once for many calls of this."""
        if self._is_set:  # mostly so, and without the lock
            return
        with self._lock:
            if self._is_closed:
                return
            self._is_set = True
            if self._fd is None:
                self._loop.call_soon_threadsafe(self._called)
            else:
                os.eventfd_write(self._fd, 1)

    def close(self) -> None:
        """Call no more, whichever threads go on to call `wake`."""
        with self._lock:
            self._is_closed = True
            fd, self._fd = self._fd, None
            if fd is not None:
                self._loop.remove_reader(fd)
                os.close(fd)

    def _read(self) -> None:
        if self._fd is not None:
            os.eventfd_read(self._fd)
        self._called()

    def _called(self) -> None:
        self._is_set = False  # before the call: what comes during it wakes again
        if not self._is_closed:
            self._on_wake()
