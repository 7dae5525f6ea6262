# SPDX-License-Identifier: Apache-2.0
"""The ways between the event loop and Zenoh's threads, for what is not a sample that comes in.

Zenoh may block a thread that sends: for a millisecond, for 50 if a message has several parts, and
for up to a minute if nothing may be lost. So a thread sends what is large or must not be lost.
"""

import asyncio
import logging
import threading
from collections import deque
from collections.abc import Callable
from typing import Final

import zenoh

from gateway.sources.source import RosError
from gateway.sources.zenoh.inbox import LoopWaker

# The thread has at most these to send: four of the largest messages that a client may publish.
MAX_WAITING_BYTES: Final = 64 * 1024**2
MAX_WAITING: Final = 4096  # messages, requests and answers
# The thread ends within this time, or is left behind: a router that takes nothing keeps it longer.
END_S: Final = 0.5

_logger = logging.getLogger(__name__)


class Outgoing:
    """The thread that sends. Everything is sent in the order in which it was given."""

    def __init__(self) -> None:
        self._waiting: deque[tuple[int, Callable[[], object]]] = deque()
        self._bytes = 0
        self._changed = threading.Condition()
        self._is_closed = False
        self._thread = threading.Thread(target=self._run, name="zenoh_send", daemon=True)
        self._thread.start()

    @property
    def is_busy(self) -> bool:
        """True while the thread has something to send, or sends it."""
        return bool(self._waiting)

    def send(self, subject: str, size: int, send: Callable[[], object]) -> None:
        """Call *send* soon on the thread. The message has *size* bytes.

        Raises:
            RosError: ``limit_exceeded``: too much waits.
        """
        with self._changed:
            is_over = self._bytes and self._bytes + size > MAX_WAITING_BYTES
            if is_over or len(self._waiting) >= MAX_WAITING:
                what = f"{self._bytes >> 20} MiB in {len(self._waiting)} messages"
                why = f"{subject}: {what} wait for the Zenoh router, so no more is taken"
                raise RosError("limit_exceeded", f"{why}: send less, or check the network")
            self._add(size, send)

    def finish(self, withdraw: Callable[[], object]) -> None:
        """Call *withdraw* soon on the thread, however much waits: what closes must not fail."""
        with self._changed:
            self._add(0, withdraw)

    def close(self) -> None:
        """Send what waits, for a limited time, and end the thread."""
        with self._changed:
            self._is_closed = True
            self._changed.notify()
        self._thread.join(END_S)

    def _add(self, size: int, send: Callable[[], object]) -> None:
        if not self._is_closed:
            self._waiting.append((size, send))
            self._bytes += size
            self._changed.notify()

    def _run(self) -> None:
        while True:
            with self._changed:
                while not self._waiting and not self._is_closed:
                    self._changed.wait()
                if not self._waiting:
                    return
                size, send = self._waiting[0]
            try:
                send()
            except zenoh.ZError as error:
                _logger.warning("Zenoh did not send a message: %s", str(error)[:200])
            except Exception:  # the thread has to serve all the others
                _logger.exception("a message was not sent")
            with self._changed:
                self._waiting.popleft()
                self._bytes -= size


class Mailbox:
    """Carries calls from Zenoh's threads to the event loop, in order."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self.loop = loop
        self._calls: deque[Callable[[], None]] = deque()
        self._waker = LoopWaker(loop, self._wake)

    def put(self, call: Callable[[], None]) -> None:
        """Make a call on the loop soon. The caller limits how many there are."""
        self._calls.append(call)
        self._waker.wake()

    def deliver(self) -> None:
        """Make all the calls that have come so far."""
        for _ in range(len(self._calls)):
            if self._calls:  # one of the calls may do the same
                self._calls.popleft()()

    def close(self) -> None:
        """Make no more calls."""
        self._waker.close()
        self._calls.clear()

    def _wake(self) -> None:
        """Make one call: others also need the loop. One that fails delays none of the others."""
        if len(self._calls) > 1:
            self._waker.wake()
        if self._calls:
            self._calls.popleft()()
