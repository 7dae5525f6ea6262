# SPDX-License-Identifier: Apache-2.0
"""The uplink as a client of the core. It has no socket: Zenoh gets each frame in its turn."""

from collections.abc import Callable
from typing import Any, Final, NamedTuple, Protocol, cast

from gateway.access.permissions import Identity
from gateway.core.entries import Entry, Frame, QueueOwner
from gateway.core.errors import ProtocolError, StatusCode
from gateway.core.outbox import Outbox
from gateway.core.peer import Peer
from gateway.core.queue import Queue
from gateway.core.requests import CallService, Request, SendActionGoal, Subscribe
from gateway.core.router import Router
from gateway.core.session import Session
from gateway.core.topics.subscription import Subscription

NAME: Final = "uplink"  # in metrics


class Stamp(NamedTuple):
    """The data of a sample in addition to its bytes."""

    number: int  # among those of its publisher: one that is dropped leaves a gap
    source_ns: int
    publisher: bytes | None


Send = Callable[[Subscription, bytes, Stamp], None]
# Returns whether a message of a topic came from a relay: relays have it already.
TakesBack = Callable[[str, bytes], bool]


class Ways(NamedTuple):
    """The ways of samples: out, or back to where they came from."""

    send: Send
    takes_back: TakesBack


class RemoteRequest(Protocol):
    """The `form` of a call or a goal that came through Zenoh."""

    def take(self, cdr: bytes, status: int) -> None:
        """Take the answer. *status* is that of a goal."""

    def feed(self, cdr: bytes) -> None:
        """Take feedback of a goal."""

    def refuse(self, error: ProtocolError) -> None:
        """Take the reason of a refusal."""


class _UplinkQueue(Queue):
    """The samples of one subscription, which are sent in their turn."""

    __slots__ = ("_numbers", "_ways")

    def __init__(
        self, outbox: Outbox, bounds: tuple[int, int | None], owner: QueueOwner, ways: Ways
    ) -> None:
        super().__init__(outbox, *bounds, owner)
        self._ways = ways
        self._numbers: dict[bytes | None, int] = {}

    def put(self, entry: Entry, *, more: bool = False) -> bool:
        """Append a sample. Its stamp goes out with it."""
        sample = cast("Any", entry).sample
        owner = cast("Subscription", self.owner)
        if self._ways.takes_back(owner.topic_name, sample.cdr):
            self.discarded += 1
            return False
        number = self._numbers[sample.publisher] = self._numbers.get(sample.publisher, 0) + 1
        stamp = Stamp(number + owner.lost_before, sample.source_ns, sample.publisher)
        return super().put(_Waiting(entry, owner, stamp, self._ways.send), more=more)


class _Waiting:
    """A sample that waits for its turn. Plain ones go as they came, CDR."""

    __slots__ = ("_cdr", "_entry", "_owner", "_send", "_stamp", "arrived_ns", "size")

    def __init__(self, entry: Entry, owner: Subscription, stamp: Stamp, send: Send) -> None:
        self._entry, self._owner, self._stamp, self._send = entry, owner, stamp, send
        feed = owner.source
        is_plain = feed is None or (feed.encoding.image or feed.encoding.cloud) is None
        self._cdr: bytes | None = cast("Any", entry).sample.cdr if is_plain else None
        self.size = entry.size
        self.arrived_ns = entry.arrived_ns

    @property
    def is_being_encoded(self) -> bool:
        return self._cdr is None and self._entry.is_being_encoded

    def frame(self) -> Frame:
        frame = self._entry.frame() if self._cdr is None else bytes(self._cdr)
        if isinstance(frame, bytes):
            self._send(self._owner, frame, self._stamp)
        return frame


class _UplinkOutbox(Outbox):
    """The queues of the uplink."""

    def __init__(self, max_bytes: int, ways: Ways) -> None:
        super().__init__(max_bytes)
        self._ways = ways

    def open_queue(
        self, depth: int, max_bytes: int | None, owner: QueueOwner | None = None
    ) -> Queue:
        """Add a queue: of a subscription, or of the feedback of a goal."""
        if owner is None:
            return super().open_queue(depth, max_bytes)
        queue = _UplinkQueue(self, (depth, max_bytes), owner, self._ways)
        self._queues.append(queue)
        return queue


class UplinkSession(Session):
    """The uplink, as the core sees it. It notes why a topic is not offered."""

    NOT_AUTHENTICATED = "use the setting uplink.role"

    def __init__(
        self, core: Router, identity: Identity, wake: Callable[[], None], ways: Ways
    ) -> None:
        super().__init__(core, Peer(wake=wake, name=NAME, address=NAME, identity=identity))
        self.outbox: Outbox = _UplinkOutbox(self.limits.send_queue_bytes, ways)
        self.problems: dict[str, str] = {}  # by topic, the newest one

    def send_refusal(self, error: ProtocolError, request: Request | None) -> None:
        """Answer a remote request with the reason, or note that."""
        match request:
            case CallService() | SendActionGoal():
                cast("RemoteRequest", request.form).refuse(error)
            case Subscribe():
                self.problems[request.topic] = str(error)

    def respond_raw(self, request: CallService, cdr: bytes) -> None:
        """Send the response of a service."""
        cast("RemoteRequest", request.form).take(cdr, 0)

    def finish_raw(self, request: SendActionGoal, cdr: bytes, status: int) -> None:
        """Send the result of a goal."""
        cast("RemoteRequest", request.form).take(cdr, status)

    def feedback_raw(self, request: SendActionGoal, cdr: bytes) -> bytes:
        """Send a goal's feedback. The bytes are counted."""
        cast("RemoteRequest", request.form).feed(cdr)
        return cdr

    def warn(self, error: ProtocolError, request: Request) -> None:
        """Note it of a topic."""
        if isinstance(request, Subscribe):
            self.problems[request.topic] = str(error)

    def inform(self, text: str, request: Request) -> None:
        """Need nothing of it."""

    def alert(self, code: StatusCode, text: str, request: Request) -> None:
        """Ask for none of it."""
