# SPDX-License-Identifier: Apache-2.0
"""Operations that are answered later, each by its own task."""

import asyncio
import logging
import time
from collections.abc import Awaitable, Callable, Coroutine, Generator
from dataclasses import dataclass, field
from typing import Any, Final

from gateway.backports import timeout_at
from gateway.codec.error_text import truncate
from gateway.core.deadline import Deadline
from gateway.core.errors import ProtocolError, over_limit
from gateway.core.requests import Request
from gateway.core.session import Session
from gateway.sources.source import RosError

MAX_WAITING_CALLS: Final = 256  # a page that asks for all parameters of a robot when it starts
# Parameters and transforms have deadlines of seconds: a turn comes soon, or something is wrong.
ASKING_S: Final = 10.0

# The last is the machine's: no descriptors left, a full disk.
FAILURES: Final = (ProtocolError, RosError, OSError)

logger = logging.getLogger(__name__)


@dataclass(slots=True)
class _Own:
    slots: asyncio.Semaphore
    tasks: set[asyncio.Task[None]] = field(default_factory=set)


class Tasks:
    """One task per operation under way. They end with the session that asked for them."""

    def __init__(self) -> None:
        self._own: dict[Session, _Own] = {}

    def __len__(self) -> int:
        """Count the operations under way, waiting ones included."""
        return sum(len(own.tasks) for own in self._own.values())

    def start(
        self,
        session: Session,
        request: Request,
        work: Callable[[], Awaitable[None]],
        deadline: Deadline,
    ) -> None:
        """Do *work*, and answer the operation if it fails.

        As many operations of a session as its limits allow are under way at once, the others
        wait for their turn, until the deadline. *work* keeps its own.

        Raises:
            ProtocolError: too many of them wait.
        """
        own = self._own.get(session)
        if own is None:
            own = self._own[session] = _Own(asyncio.Semaphore(session.limits.max_pending_calls))
        limit = session.limits.max_pending_calls + MAX_WAITING_CALLS
        if len(own.tasks) >= limit:
            raise over_limit(limit, "unfinished calls per client", "max_pending_calls")
        loop = asyncio.get_running_loop()
        running = _run(own.slots, session, request, work, deadline)
        task = loop.create_task(Metered(running, session))
        own.tasks.add(task)
        task.add_done_callback(own.tasks.discard)

    def leave(self, session: Session) -> None:
        """Cancel everything that is under way for a client."""
        own = self._own.pop(session, None)
        if own is not None:
            for task in own.tasks:
                task.cancel()


class Metered(Coroutine[Any, Any, None]):
    """A coroutine whose steps are charged to a client's time budget."""

    def __init__(self, inner: Coroutine[Any, Any, None], session: Session) -> None:
        self._inner = inner
        self._session = session

    def __await__(self) -> Generator[Any, Any, None]:
        """Await the inner one, uncharged."""
        return self._inner.__await__()

    def send(self, value: Any, /) -> Any:
        """Go on to the next await."""
        start_s = time.monotonic()
        try:
            return self._inner.send(value)
        finally:
            self._spend(start_s)

    def throw(self, *error: Any) -> Any:
        """Go on with an exception."""
        start_s = time.monotonic()
        try:
            return self._inner.throw(*error)
        finally:
            self._spend(start_s)

    def close(self) -> None:
        """End it where it waits."""
        self._inner.close()

    def _spend(self, start_s: float) -> None:
        now_s = time.monotonic()
        self._session.turns.spend(now_s - start_s, now_s)


def refuse(session: Session, request: Request, error: Exception) -> None:
    """Answer an operation that has failed by one of `FAILURES`."""
    match error:
        case ProtocolError():
            session.refuse(error, request)
        case RosError():
            session.refuse(ProtocolError(error.code, truncate(str(error))), request)
        case OSError():
            reason = (error.strerror or type(error).__name__).lower()  # its text may name a file
            extra = {"client": session.client}
            logger.warning("%s failed: %s", request.kind, reason, extra=extra)
            session.refuse(ProtocolError("internal", f"the gateway's machine: {reason}"), request)


async def answered(session: Session, request: Request, work: Callable[[], Awaitable[None]]) -> None:
    """Do *work*. If it fails, the error is the answer to the request."""
    try:
        await work()
    except FAILURES as error:
        refuse(session, request, error)
    except Exception:  # our bug: this client is told, the others are unharmed
        logger.exception("%s failed", request.kind, extra={"client": session.client})
        session.refuse(ProtocolError("internal", "a fault of the gateway: see its log"), request)


async def _run(
    slots: asyncio.Semaphore,
    session: Session,
    request: Request,
    work: Callable[[], Awaitable[None]],
    deadline: Deadline,
) -> None:
    try:
        async with timeout_at(deadline.at_s):
            await slots.acquire()
    except TimeoutError:
        waiting = session.limits.max_pending_calls
        text = f"{waiting} other calls of this client still wait for an answer: send fewer at once"
        session.refuse(ProtocolError("timeout", text), request)
        return
    try:
        await answered(session, request, work)
    finally:
        slots.release()
