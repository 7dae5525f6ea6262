# SPDX-License-Identifier: Apache-2.0
"""Where frames are in each other, for clients that keep no transform tree of their own."""

import asyncio
import time
from dataclasses import dataclass
from typing import Any, Final, NamedTuple

import orjson

from gateway.codec.json import dumps
from gateway.codec.words import cut
from gateway.ports import Ros
from gateway.protocol import frames
from gateway.protocol.errors import ProtocolError
from gateway.protocol.operations.transforms import CancelTransform, LookupTransform
from gateway.protocol.outbox import Lane
from gateway.protocol.session import Session
from gateway.router.tf_listener import TfListener
from gateway.router.topic_types import TopicTypes
from gateway.tf.buffer import Buffer, Found
from gateway.tf.errors import ExtrapolationError, TransformError

DEFAULT_TIMEOUT_S: Final = 1.0  # a first lookup has to discover the publishers


class Transforms:
    """Listens to ``/tf`` and ``/tf_static`` while somebody looks transforms up, and answers.

    Runs on the event loop's thread.
    """

    def __init__(self, ros: Ros, types: TopicTypes) -> None:
        self._listener = TfListener(ros, types)
        self._standing: dict[Session, dict[str | int | None, _Standing]] = {}
        self._rounds: dict[_Pair, _Round] = {}

    @property
    def standing(self) -> int:
        """How many standing lookups there are."""
        return sum(map(len, self._standing.values()))

    async def lookup(self, request: LookupTransform) -> dict[str, Any]:
        """Wait until a transform is known; return the members of the answer.

        Raises:
            ProtocolError: ``not_found``: a frame is unknown, or they are not connected;
                ``timeout``: the time asked for has not come; ``bad_type``: no tf here.
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
                        raise _refusal(error) from error
        finally:
            listener.release()

    def watch(self, session: Session, request: LookupTransform) -> None:
        """Send a transform again and again; replaces the standing lookup with the same id.

        Raises:
            ProtocolError: it is refused, and nothing has changed.
            RosError: ROS refuses the subscriptions.
        """
        if request.time is not None:
            raise ProtocolError("bad_request", "time: a repeated one takes the newest")
        if request.rate is None:
            raise ProtocolError("bad_request", "rate: missing; it makes a lookup a repeated one")
        own = self._standing.get(session, {})
        limit = session.limits.transforms
        if request.id not in own and len(own) >= limit:
            raise ProtocolError("limit_exceeded", f"at most {limit} repeated lookups per client")
        self._listener.acquire()
        if request.id in own:
            self._end(session, request.id)
        pair = _Pair(request.target_frame, request.source_frame, request.rate)
        lane = session.outbox.open_lane(1, None)  # beside a new transform an old one is of no use
        standing = _Standing(session, request, pair, lane, round(_timeout_s(request) * 1e9))
        self._standing.setdefault(session, {})[request.id] = standing
        if pair not in self._rounds:
            self._rounds[pair] = _Round(pair, self._listener.buffer)
        self._rounds[pair].join(standing)

    def cancel(self, session: Session, request: CancelTransform) -> None:
        """End a standing lookup.

        Raises:
            ProtocolError: there is none with this id.
        """
        if request.id not in self._standing.get(session, {}):
            raise ProtocolError("not_found", f"no repeated lookup with id {request.id!r}")
        self._end(session, request.id)

    def leave(self, session: Session) -> None:
        """End everything that stands for a client."""
        for request_id in list(self._standing.get(session, {})):
            self._end(session, request_id)

    def close(self) -> None:
        """End all and the ROS subscriptions."""
        for session in list(self._standing):
            self.leave(session)
        self._listener.close()

    def _end(self, session: Session, request_id: str | int | None) -> None:
        own = self._standing[session]
        standing = own.pop(request_id)
        if not own:
            del self._standing[session]
        if self._rounds[standing.pair].leave(standing):
            del self._rounds[standing.pair]
        session.outbox.close_lane(standing.lane)
        self._listener.release()


class _Pair(NamedTuple):
    """What standing lookups must have in common to be computed once."""

    target: str
    source: str
    rate: float


@dataclass(slots=True)
class _Standing:
    """One client's standing lookup."""

    session: Session
    request: LookupTransform
    pair: _Pair
    lane: Lane
    patience_ns: int
    missing_since_ns: int | None = None
    was_told: bool = False  # what is missing


class _Frame:
    """A transform on its way to one client."""

    __slots__ = ("_wire", "size")

    def __init__(self, wire: bytes) -> None:
        self._wire = wire
        self.size = len(wire)

    @property
    def is_being_rendered(self) -> bool:
        """Whether work on it is under way: never."""
        return False

    def wire(self) -> bytes:
        """Return the bytes to send."""
        return self._wire


class _Round:
    """Looks one pair up at one rate, for all who stand on it."""

    def __init__(self, pair: _Pair, buffer: Buffer) -> None:
        self._pair = pair
        self._buffer = buffer
        self._members: list[_Standing] = []
        self._seen = -1  # the buffer's revision
        self._sent: Found | None = None
        self._body = b""  # of what was sent, as JSON
        self._loop = asyncio.get_running_loop()
        self._due = self._loop.time()
        self._timer = self._loop.call_at(self._due, self._turn)

    def join(self, standing: _Standing) -> None:
        """Send to one more, at once what the others have."""
        self._members.append(standing)
        if self._sent is not None:
            self._put(standing)

    def leave(self, standing: _Standing) -> bool:
        """Send to one less; return whether nobody is left."""
        self._members.remove(standing)
        if not self._members:
            self._timer.cancel()
        return not self._members

    def _turn(self) -> None:
        # keep the beat; begin a new one where the loop has been busy for longer than that
        self._due = max(self._due + 1 / self._pair.rate, self._loop.time())
        self._timer = self._loop.call_at(self._due, self._turn)
        if self._buffer.revision != self._seen or self._sent is None:
            self._seen = self._buffer.revision
            self._look()

    def _look(self) -> None:
        target, source, _ = self._pair
        try:
            found = self._buffer.lookup(target, source)
        except TransformError as error:
            self._sent = None
            self._complain(error)
            return
        if found == self._sent:
            return
        self._sent = found
        self._body = dumps(_transform_stamped(target, source, found))
        for standing in list(self._members):
            self._put(standing)

    def _put(self, standing: _Standing) -> None:
        standing.missing_since_ns = None
        standing.was_told = False
        request_id = standing.request.id
        identity = b"" if request_id is None else b',"id":' + orjson.dumps(request_id)
        payload = b'{"op":"lookup_transform"%b,"transform":%b}' % (identity, self._body)
        standing.lane.put(_Frame(standing.session.framed(payload)))
        standing.session.wake()

    def _complain(self, error: TransformError) -> None:
        """Tell each client once what is missing, when its patience is over."""
        now_ns = time.monotonic_ns()
        for standing in list(self._members):
            if standing.missing_since_ns is None:
                standing.missing_since_ns = now_ns
            missing_ns = now_ns - standing.missing_since_ns
            if missing_ns >= standing.patience_ns and not standing.was_told:
                standing.was_told = True
                refusal = _refusal(error)
                waiting = ProtocolError(refusal.code, f"{refusal}; waiting for it")
                standing.session.warn(waiting, standing.request.op, standing.request.id)


def _timeout_s(request: LookupTransform) -> float:
    return DEFAULT_TIMEOUT_S if request.timeout is None else request.timeout


def _look(buffer: Buffer, request: LookupTransform) -> dict[str, Any]:
    target, source, asked = request.target_frame, request.source_frame, request.time
    # a zero time is the newest one, as in tf2
    stamp_ns = None if asked is None else asked.sec * 1_000_000_000 + asked.nanosec or None
    return _transform_stamped(target, source, buffer.lookup(target, source, stamp_ns))


def _refusal(error: TransformError) -> ProtocolError:
    is_late = isinstance(error, ExtrapolationError)
    return ProtocolError("timeout" if is_late else "not_found", cut(str(error)))


def _transform_stamped(target: str, source: str, found: Found) -> dict[str, Any]:
    """Return geometry_msgs/msg/TransformStamped: *source* in *target*, as they are spelt."""
    x, y, z, qx, qy, qz, qw = found.transform
    return {
        "header": {"stamp": frames.time(found.stamp_ns), "frame_id": target},
        "child_frame_id": source,
        "transform": {
            "translation": {"x": x, "y": y, "z": z},
            "rotation": {"x": qx, "y": qy, "z": qz, "w": qw},
        },
    }
