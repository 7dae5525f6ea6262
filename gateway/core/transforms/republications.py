# SPDX-License-Identifier: Apache-2.0
"""Arrays of transforms for clients, of which each message has the frames that have moved."""

import asyncio
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final, NamedTuple

from gateway.codec.json import dumps
from gateway.core.entries import NOTHING, Frame
from gateway.core.errors import ProtocolError, over_limit
from gateway.core.queue import Queue
from gateway.core.requests import Request
from gateway.core.session import Session
from gateway.core.transforms.answers import refusal, transform_stamped
from gateway.core.transforms.rate_limiter import RateLimiter
from gateway.core.transforms.tf_listener import TfListener
from gateway.tf.buffer import Buffer
from gateway.tf.errors import TransformError
from gateway.tf.rigid import Rigid

# While none of its frames is known, so that a slow array begins as soon as others do.
RETRY_S: Final = 0.1
WARN_AFTER_S: Final = 1.0  # a first lookup has to discover the publishers
_MAX_REASONS: Final = 8  # that are looked for, the first of them is reported
# A lookup takes 2 to 300 us, by the depth of the tree and by the ages of its transforms. After a
# slice others have their turn, as after one of what a client sends.
SLICE_S: Final = 0.004
PAUSE_S: Final = 0.02  # between questions whether a client has time left to spend


class ArrayKey(NamedTuple):
    """The array that a client asks for. Those with equal keys are computed once."""

    target: str
    sources: tuple[str, ...]
    rate_hz: float
    angular_thres: float
    trans_thres: float


@dataclass(slots=True, eq=False)
class Republication:
    """One array that a client has asked for.

    *wrap* makes the bytes for the wire of the JSON of an array. No bytes if nobody wants any.
    """

    session: Session
    key: ArrayKey
    request: Request  # which warnings are about
    wrap: Callable[[bytes], bytes]
    queue: Queue
    has_begun: bool = False
    _last: "_Moved | None" = field(default=None, repr=False)
    _warning: asyncio.TimerHandle | None = field(default=None, repr=False)

    def offer(self, moved: Mapping[str, bytes]) -> None:
        """Send transforms, by their frames, together with those that still wait to be sent."""
        last = self._last
        if last is not None and not last.is_sent:  # it waits, or an outbox without room dropped it
            moved = {**last.transforms, **moved}
        self._last = _Moved(moved, self.wrap)
        self.queue.put(self._last)
        self.session.wake()

    def warn_later(self, array: "_SharedArray") -> None:
        """Warn the client of frames that are still missing after a while."""
        loop = asyncio.get_running_loop()
        self._warning = loop.call_later(WARN_AFTER_S, self._warn, array)

    def stop(self) -> None:
        """Warn of nothing any more."""
        if self._warning is not None:
            self._warning.cancel()

    def _warn(self, array: "_SharedArray") -> None:
        missing = array.missing()
        reason = array.reason(missing)
        if reason is not None:
            others = f", and {len(missing) - 1} more are missing" if len(missing) > 1 else ""
            warning = ProtocolError(reason.code, f"{reason}{others}; waiting")
            self.session.warn(warning, self.request)


class Republications:
    """Keeps the arrays of all clients, and sends them as the transforms change.

    Runs on the event loop's thread.
    """

    def __init__(self, listener: TfListener) -> None:
        self._listener = listener
        self._own: dict[Session, set[Republication]] = {}
        self._shared: dict[ArrayKey, _SharedArray] = {}
        listener.follow(self._on_change)

    def __len__(self) -> int:
        """Count the arrays of all clients."""
        return sum(map(len, self._own.values()))

    def add(
        self,
        session: Session,
        key: ArrayKey,
        request: Request,
        wrap: Callable[[bytes], bytes],
    ) -> Republication:
        """Add an array. Nothing is sent until it begins.

        Raises:
            ProtocolError: the client has too many, or tf2_msgs is missing. Nothing has changed.
            RosError: ROS refuses the subscriptions.
        """
        own = self._own.get(session, set())
        limit = session.limits.max_transforms
        if len(own) >= limit:
            raise over_limit(limit, "arrays of transforms per client", "max_transforms")
        self._listener.acquire()
        queue = session.outbox.open_queue(1, None)  # a newer array replaces one that waits
        added = Republication(session, key, request, wrap, queue)
        self._own.setdefault(session, own).add(added)
        return added

    def begin(self, republication: Republication) -> None:
        """Send all frames as they are, and then those that move.

        Called again, it sends all frames again.
        """
        key = republication.key
        if key not in self._shared:
            self._shared[key] = _SharedArray(key, self._listener.buffer)
        if not republication.has_begun:
            republication.has_begun = True
            republication.warn_later(self._shared[key])
            self._shared[key].members.append(republication)
        self._shared[key].send_all(republication)

    def end(self, republication: Republication) -> None:
        """Send no more of an array, and forget it."""
        session, key = republication.session, republication.key
        own = self._own[session]
        own.remove(republication)
        if not own:
            del self._own[session]
        republication.stop()
        if republication.has_begun:
            shared = self._shared[key]
            shared.members.remove(republication)
            if not shared.members:
                shared.stop()
                del self._shared[key]
        session.outbox.close_queue(republication.queue)
        self._listener.release()

    def leave(self, session: Session) -> None:
        """End the arrays of a client."""
        for republication in list(self._own.get(session, ())):
            self.end(republication)

    def _on_change(self) -> None:
        for shared in self._shared.values():
            shared.wake()


class _Moved:
    """Transforms in one client's outbox, by their frames."""

    __slots__ = ("_wrap", "is_sent", "size", "transforms")

    is_being_encoded = False
    arrived_ns = 0

    def __init__(self, transforms: Mapping[str, bytes], wrap: Callable[[bytes], bytes]) -> None:
        self.transforms = transforms
        self.size = sum(map(len, transforms.values()))
        self.is_sent = False
        self._wrap = wrap

    def frame(self) -> Frame:
        """Return the bytes to send."""
        self.is_sent = True
        return self._wrap(b"[%b]" % b",".join(self.transforms.values())) or NOTHING


class _Sent(NamedTuple):
    """A transform as it was sent last."""

    transform: Rigid
    stamped: bytes  # geometry_msgs/msg/TransformStamped as JSON


class _SharedArray:
    """Looks the frames of an array up when the buffer changes, for all clients that ask for it.

    All of them have got the same: to one that comes later it sends what was sent to the others
    before. So each knows where a frame is up to the thresholds.

    The time that it takes is that of its clients. Once they have spent theirs it goes on later, and
    then sends less often than at its rate.
    """

    def __init__(self, key: ArrayKey, buffer: Buffer) -> None:
        self.members: list[Republication] = []
        self._key = key
        self._buffer = buffer
        self._sent: dict[str, _Sent] = {}
        self._moved: dict[str, bytes] = {}  # so far, in this turn
        self._left: Iterator[str] = iter(())  # to be looked up in this turn
        self._next_slice: asyncio.Handle | None = None
        self._limiter = RateLimiter(key.rate_hz, self._turn)

    def wake(self) -> None:
        """Look again when the rate allows it: the buffer has changed."""
        self._limiter.wake()

    def stop(self) -> None:
        """Look no more."""
        self._limiter.stop()
        if self._next_slice is not None:
            self._next_slice.cancel()

    def send_all(self, member: Republication) -> None:
        """Send a client all that is known to the others."""
        if self._sent:
            member.offer({source: sent.stamped for source, sent in self._sent.items()})

    def missing(self) -> list[str]:
        """Return the frames that were never sent."""
        return [source for source in self._key.sources if source not in self._sent]

    def reason(self, missing: Sequence[str]) -> ProtocolError | None:
        """Return the reason why the first of some frames is not known, if it is not."""
        for source in missing[:_MAX_REASONS]:
            try:
                self._buffer.lookup(self._key.target, source)
            except TransformError as error:
                return refusal(error)
        return None

    def _turn(self) -> None:
        if self._next_slice is not None:  # of the turn before
            self._limiter.wake()
            return
        self._left = iter(self._key.sources)
        self._moved = {}
        self._work()

    def _work(self) -> None:
        """Look up as many frames as a slice allows. After the last one, send what has moved."""
        self._next_slice = None
        loop = asyncio.get_running_loop()
        if not self._spend(0.0):
            self._next_slice = loop.call_later(PAUSE_S, self._work)
            return
        start_s = time.monotonic()
        for source in self._left:
            self._look(source)
            if time.monotonic() > start_s + SLICE_S:
                self._next_slice = loop.call_soon(self._work)
                break
        else:
            self._finish()
        self._spend(time.monotonic() - start_s)

    def _spend(self, spent_s: float) -> bool:
        """Take time from the clients. Return whether any of them has some left."""
        now_s = time.monotonic()
        share_s = spent_s / max(1, len(self.members))
        left = [member.session.turns.spend(share_s, now_s) for member in self.members]
        return any(left)

    def _look(self, source: str) -> None:
        try:
            found = self._buffer.lookup(self._key.target, source)
        except TransformError:
            return  # it may come, or come again
        if self._has_moved(source, found.transform):
            stamped = dumps(transform_stamped(self._key.target, source, found))
            self._sent[source] = _Sent(found.transform, stamped)
            self._moved[source] = stamped

    def _finish(self) -> None:
        if self._moved:
            for member in self.members:
                member.offer(self._moved)
        elif not self._sent:
            self._limiter.retry_after(RETRY_S)

    def _has_moved(self, source: str, transform: Rigid) -> bool:
        sent = self._sent.get(source)
        if sent is None:
            return True
        key = self._key
        return (
            transform.distance(sent.transform) > key.trans_thres
            or transform.angle(sent.transform) > key.angular_thres
        )
