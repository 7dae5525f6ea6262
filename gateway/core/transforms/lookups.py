# SPDX-License-Identifier: Apache-2.0
"""Lookups of transforms, for clients without their own transform tree."""

import asyncio
from dataclasses import dataclass
from typing import Any, Final, NamedTuple

from gateway.codec.json import dumps
from gateway.core.errors import NothingThereError, ProtocolError, over_limit
from gateway.core.queue import Queue
from gateway.core.requests import CancelTransform, LookupTransform
from gateway.core.session import Session
from gateway.core.transforms.answers import refusal, transform_stamped
from gateway.core.transforms.rate_limiter import RateLimiter
from gateway.core.transforms.tf_listener import RETRY_S, TfListener
from gateway.tf.buffer import Buffer, FoundTransform
from gateway.tf.errors import ExtrapolationError, TransformError

DEFAULT_TIMEOUT_S: Final = 1.0  # a first lookup has to discover the publishers


class TransformLookups:
    """Listens to ``/tf`` and ``/tf_static`` while clients look transforms up, and answers.

    Runs on the event loop's thread.
    """

    def __init__(self, listener: TfListener) -> None:
        self._listener = listener
        listener.follow(self._on_change)
        self._periodic: dict[Session, dict[str | int | None, _PeriodicLookup]] = {}
        self._shared: dict[_Pair, _SharedLookup] = {}

    @property
    def periodic(self) -> int:
        """The number of periodic lookups of all clients."""
        return sum(map(len, self._periodic.values()))

    async def lookup(self, request: LookupTransform) -> dict[str, Any]:
        """Wait until a transform is known. Return the members of the answer.

        Raises:
            ProtocolError: ``not_found``: a frame is unknown, or they are not connected.
                ``timeout``: the requested time has not come. ``bad_type``: tf2_msgs is missing.
            RosError: ROS refuses the subscriptions.
        """
        listener = self._listener
        listener.acquire()
        try:
            deadline = asyncio.get_running_loop().time() + _timeout_s(request)
            while True:
                try:
                    return {"transform": _look(listener.buffer, request)}
                except TransformError as error:
                    is_lost = isinstance(error, ExtrapolationError) and error.is_early
                    if is_lost or not await listener.news(deadline):
                        raise refusal(error) from error
        finally:
            listener.release()

    def watch(self, session: Session, request: LookupTransform) -> None:
        """Send a transform periodically. Replace the periodic lookup with the same id.

        Raises:
            ProtocolError: it is refused, and nothing has changed.
            RosError: ROS refuses the subscriptions.
        """
        if request.stamp_ns is not None:
            raise ProtocolError(
                "bad_request", "time: not allowed with rate, which sends the newest"
            )
        if request.rate is None:
            raise ProtocolError("bad_request", "rate: missing, add it to repeat the lookup")
        own = self._periodic.get(session, {})
        limit = session.limits.max_transforms
        if request.id not in own and len(own) >= limit:
            raise over_limit(limit, "repeated lookups per client", "max_transforms")
        self._listener.acquire()
        if request.id in own:
            self._end(session, request.id)
        pair = _Pair(request.target_frame, request.source_frame, request.rate)
        queue = session.outbox.open_queue(1, None)  # a new transform makes an old one useless
        periodic = _PeriodicLookup(session, request, pair, queue)
        self._periodic.setdefault(session, {})[request.id] = periodic
        if pair not in self._shared:
            self._shared[pair] = _SharedLookup(pair, self._listener.buffer)
        self._shared[pair].join(periodic)

    def cancel(self, session: Session, request: CancelTransform) -> None:
        """End a periodic lookup.

        Raises:
            ProtocolError: the id is unknown.
        """
        if request.id not in self._periodic.get(session, {}):
            raise NothingThereError(f"no repeated lookup with id {request.id!r}")
        self._end(session, request.id)

    def leave(self, session: Session) -> None:
        """End the periodic lookups of a client."""
        for request_id in list(self._periodic.get(session, {})):
            self._end(session, request_id)

    def close(self) -> None:
        """End all lookups."""
        for session in list(self._periodic):
            self.leave(session)

    def _end(self, session: Session, request_id: str | int | None) -> None:
        own = self._periodic[session]
        periodic = own.pop(request_id)
        if not own:
            del self._periodic[session]
        if self._shared[periodic.pair].leave(periodic):
            del self._shared[periodic.pair]
        session.outbox.close_queue(periodic.queue)
        self._listener.release()

    def _on_change(self) -> None:
        for each in self._shared.values():
            each.wake()


class _Pair(NamedTuple):
    """The frames of a lookup and its rate. Periodic lookups with equal ones are computed once."""

    target: str
    source: str
    rate: float


@dataclass(slots=True)
class _PeriodicLookup:
    """One client's periodic lookup."""

    session: Session
    request: LookupTransform
    pair: _Pair
    queue: Queue
    # set while the transform is missing, also after it has run out
    warning_timer: asyncio.TimerHandle | None = None

    def stop_waiting(self) -> None:
        """Stop waiting for a missing transform."""
        if self.warning_timer is not None:
            self.warning_timer.cancel()
            self.warning_timer = None


class _TransformFrame:
    """A transform in one client's outbox."""

    __slots__ = ("_frame", "size")

    arrived_ns = 0

    def __init__(self, frame: bytes) -> None:
        self._frame = frame
        self.size = len(frame)

    @property
    def is_being_encoded(self) -> bool:
        """Never true: it is encoded."""
        return False

    def frame(self) -> bytes:
        """Return the bytes to send."""
        return self._frame


class _SharedLookup:
    """Looks one pair up when the buffer changes, at a limited rate, for all lookups of the pair."""

    def __init__(self, pair: _Pair, buffer: Buffer) -> None:
        self._pair = pair
        self._buffer = buffer
        self._lookups: list[_PeriodicLookup] = []
        self._sent: FoundTransform | None = None
        self._body = b""  # of the last frame sent, as JSON
        self._limiter = RateLimiter(pair.rate, self._turn)

    def join(self, periodic: _PeriodicLookup) -> None:
        """Add a lookup, and send it the current transform at once."""
        self._lookups.append(periodic)
        if self._sent is not None:
            self._put(periodic)
        else:
            self._miss(periodic)

    def leave(self, periodic: _PeriodicLookup) -> bool:
        """Remove a lookup. Return whether none is left."""
        self._lookups.remove(periodic)
        periodic.stop_waiting()
        if not self._lookups:
            self._limiter.stop()
        return not self._lookups

    def wake(self) -> None:
        """Look again when the rate allows it: the buffer has changed."""
        self._limiter.wake()

    def _turn(self) -> None:
        try:
            found = self._buffer.lookup(self._pair.target, self._pair.source)
        except TransformError:
            self._limiter.retry_after(RETRY_S)  # nothing is sent, so this is not too often
            self._sent = None
            for periodic in self._lookups:
                self._miss(periodic)
            return
        if found == self._sent:
            return
        self._sent = found
        self._body = dumps(transform_stamped(self._pair.target, self._pair.source, found))
        for periodic in list(self._lookups):
            self._put(periodic)

    def _put(self, periodic: _PeriodicLookup) -> None:
        periodic.stop_waiting()
        frame = periodic.session.transform_frame(periodic.request.id, self._body)
        periodic.queue.put(_TransformFrame(frame))
        periodic.session.wake()

    def _miss(self, periodic: _PeriodicLookup) -> None:
        if periodic.warning_timer is None:
            timeout_s = _timeout_s(periodic.request)
            loop = asyncio.get_running_loop()
            periodic.warning_timer = loop.call_later(timeout_s, self._warn, periodic)

    def _warn(self, periodic: _PeriodicLookup) -> None:
        """Warn a client of a missing transform, once until the transform is there again."""
        try:
            self._buffer.lookup(self._pair.target, self._pair.source)
        except TransformError as error:
            reason = refusal(error)
            waiting = ProtocolError(reason.code, f"still waiting: {reason}")
            periodic.session.warn(waiting, periodic.request)


def _timeout_s(request: LookupTransform) -> float:
    return DEFAULT_TIMEOUT_S if request.timeout is None else request.timeout


def _look(buffer: Buffer, request: LookupTransform) -> dict[str, Any]:
    target, source = request.target_frame, request.source_frame
    stamp_ns = request.stamp_ns or None  # a zero time is the newest one, as in tf2
    return transform_stamped(target, source, buffer.lookup(target, source, stamp_ns))
