# SPDX-License-Identifier: Apache-2.0
"""What is closed but deferred until what it wrote last has been heard.

DDS tells of an entity's end and of what it has written by different ways, and a reader drops what
comes from a writer that has ended: of messages and responses that were written just before, one in
fifteen was lost on one machine, of those written 10 ms before none.
"""

import asyncio
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

DEFERRED_S: Final = 0.5  # a lost packet is sent again well within
SHUTDOWN_S: Final = 0.05  # when all ends: the loop waits for it
MAX_DEFERRED: Final = 64  # a client may open and close as fast as it likes


@dataclass(eq=False, slots=True)
class Deferred:
    """One thing that is deferred."""

    subject: str
    type_name: str
    destroy: Callable[[], None]
    timer: asyncio.TimerHandle | None = None


class DeferredDestruction:
    """Destroys what it is given a little later."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop
        self._deferred: dict[Deferred, None] = {}  # the oldest first

    def defer(self, subject: str, type_name: str, destroy: Callable[[], None]) -> Deferred:
        """Call *destroy* in `DEFERRED_S`; *subject* is such as ``service /reset``."""
        deferred = Deferred(subject, type_name, destroy)
        deferred.timer = self._loop.call_later(DEFERRED_S, self._end, deferred)
        self._deferred[deferred] = None
        if len(self._deferred) > MAX_DEFERRED:
            self._end(next(iter(self._deferred)))
        return deferred

    def cancel(self, deferred: Deferred) -> None:
        """Destroy nothing: it is in use again."""
        if deferred.timer is not None:
            deferred.timer.cancel()
        del self._deferred[deferred]

    def is_deferred(self, subject: str) -> bool:
        """Whether something is deferred of a subject."""
        return any(deferred.subject == subject for deferred in self._deferred)

    def destroy_now(self, subject: str, *, except_type: str | None = None) -> None:
        """Destroy at once what is deferred of a subject, unless its type is *except_type*."""
        for deferred in list(self._deferred):
            if deferred.subject == subject and deferred.type_name != except_type:
                self._end(deferred)

    def close(self) -> None:
        """Destroy all that is left, once it has been heard."""
        if self._deferred:
            time.sleep(SHUTDOWN_S)
        while self._deferred:
            self._end(next(iter(self._deferred)))

    def _end(self, deferred: Deferred) -> None:
        self.cancel(deferred)
        deferred.destroy()
