# SPDX-License-Identifier: Apache-2.0
"""Destruction of closed entities, deferred until their last messages have been delivered.

DDS announces the end of an entity by another way than it sends what that has written, and a reader
drops what comes from a writer that has ended. Of the messages and responses that were written just
before the end, one in fifteen was lost on one machine. Of those written 10 ms before, none.
"""

import asyncio
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

DEFERRED_S: Final = 0.5  # a lost packet has been sent again well before
SHUTDOWN_S: Final = 0.05  # at shutdown, where it blocks the loop
MAX_DEFERRED: Final = 64  # a client may open and close as fast as it likes


@dataclass(eq=False, slots=True)
class Deferred:
    """One destruction that is deferred."""

    subject: str
    type_name: str
    destroy: Callable[[], None]
    timer: asyncio.TimerHandle | None = None


class DeferredDestruction:
    """Destroys closed entities a little later."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop
        self._deferred: dict[Deferred, None] = {}  # the oldest first

    def defer(self, subject: str, type_name: str, destroy: Callable[[], None]) -> Deferred:
        """Call *destroy* after `DEFERRED_S`. *subject* is for example ``service /reset``."""
        deferred = Deferred(subject, type_name, destroy)
        deferred.timer = self._loop.call_later(DEFERRED_S, self._end, deferred)
        self._deferred[deferred] = None
        if len(self._deferred) > MAX_DEFERRED:
            self._end(next(iter(self._deferred)))
        return deferred

    def cancel(self, deferred: Deferred) -> None:
        """Cancel a destruction: the entity is in use again."""
        if deferred.timer is not None:
            deferred.timer.cancel()
        del self._deferred[deferred]

    def is_deferred(self, subject: str) -> bool:
        """Return whether a destruction is deferred for a subject."""
        return any(deferred.subject == subject for deferred in self._deferred)

    def destroy_now(self, subject: str, *, except_type: str | None = None) -> None:
        """Destroy at once what is deferred for a subject, unless its type is *except_type*."""
        for deferred in list(self._deferred):
            if deferred.subject == subject and deferred.type_name != except_type:
                self._end(deferred)

    def close(self) -> None:
        """Destroy all that is left, `SHUTDOWN_S` later so that it has been delivered."""
        if self._deferred:
            time.sleep(SHUTDOWN_S)
        while self._deferred:
            self._end(next(iter(self._deferred)))

    def _end(self, deferred: Deferred) -> None:
        self.cancel(deferred)
        deferred.destroy()
