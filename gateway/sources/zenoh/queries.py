# SPDX-License-Identifier: Apache-2.0
"""Queries that wait for the event loop. The oldest make room for newer ones."""

import threading
from collections import deque
from collections.abc import Callable
from typing import Any, Final

from gateway.config.limits import MAX_QUEUE_DEPTH
from gateway.sources.zenoh.outgoing import Mailbox

# Of one queryable, until the loop takes them
MAX_WAITING_BYTES: Final = 16 * 1024**2


class WaitingQueries:
    """Gives queries to *take* on the loop, one after the other."""

    def __init__(self, mailbox: Mailbox, take: Callable[[Any], None]) -> None:
        self._mailbox, self._give = mailbox, take
        self._waiting: deque[tuple[int, Any]] = deque()  # the size of a query, and the query
        self._bytes = 0
        self._lock = threading.Lock()
        self._is_called = False  # soon, by the mailbox
        self._is_draining = self._is_closed = False

    def arrive(self, query: Any) -> None:
        """Take a query in, on any thread."""
        size = 0 if query.payload is None else len(query.payload)
        with self._lock:
            self._waiting.append((size, query))
            self._bytes += size
        while self._is_over() and (oldest := self._next()) is not None:
            oldest.drop()
        self._call()

    def drain(self) -> None:
        """Give all that have arrived. Called from within that, do nothing."""
        if self._is_draining:
            return
        self._is_draining = True
        try:
            for _ in range(len(self._waiting)):
                self._give_one()
        finally:
            self._is_draining = False

    def close(self) -> None:
        """Give no more."""
        self._is_closed = True

    def drop(self) -> None:
        """Let those who wait know that no answer comes, on any thread."""
        while (waiting := self._next()) is not None:
            waiting.drop()

    def _is_over(self) -> bool:
        count = len(self._waiting)
        return count > MAX_QUEUE_DEPTH or (count > 1 and self._bytes > MAX_WAITING_BYTES)

    def _next(self) -> Any:
        """Return the oldest query that waits, or None. An earlier turn may have drained it."""
        with self._lock:
            if not self._waiting:
                return None
            size, query = self._waiting.popleft()
            self._bytes -= size
            return query

    def _call(self) -> None:
        """Have one query taken soon. However many wait, others get their turns in between."""
        if not self._is_called:
            self._is_called = True
            self._mailbox.put(self._take)

    def _take(self) -> None:
        self._is_called = False
        if self._is_draining or self._is_closed:
            return
        if len(self._waiting) > 1:  # before this one: it may fail
            self._call()
        self._give_one()

    def _give_one(self) -> None:
        query = self._next()
        if query is not None:
            self._give(query)


def read_query(query: Any) -> tuple[bytes, bytes]:
    """Return the attachment and the payload of a query."""
    sender, payload = query.attachment, query.payload
    return (
        b"" if sender is None else sender.to_bytes(),
        b"" if payload is None else payload.to_bytes(),
    )
