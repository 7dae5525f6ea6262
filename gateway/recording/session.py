# SPDX-License-Identifier: Apache-2.0
"""The recorder as a client of the core. It has no socket: a thread writes what it gets.

Samples are recorded when they come, as CDR. So nothing is encoded, and nothing waits in the outbox
but pictures.
"""

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Final, cast

from gateway.access.permissions import Identity
from gateway.core.entries import Entry, Frame, QueueOwner
from gateway.core.errors import ProtocolError, StatusCode
from gateway.core.outbox import Outbox
from gateway.core.peer import Peer
from gateway.core.queue import Queue
from gateway.core.requests import Request, Subscribe
from gateway.core.router import Router
from gateway.core.session import Session
from gateway.core.topics.subscription import Feed, Subscription
from gateway.recording.entries import RecordedMessage, RecordedTopic

if TYPE_CHECKING:
    from gateway.core.topics.encoding import PerClientFrame, SharedFrame

# Raw pictures of a camera that wait for a worker.
MAX_WAITING_PICTURES: Final = 4
# The same of all cameras together.
MAX_WAITING_PICTURE_BYTES: Final = 64 * 1024**2

NAME: Final = "recorder"  # in metrics

OpenTopic = Callable[[Subscription], RecordedTopic | None]
Put = Callable[[RecordedMessage], None]


class RecordedQueue(Queue):
    """The samples of one subscription, which are recorded as they come."""

    __slots__ = ("_feed", "_open_topic", "_put", "_topic")

    def __init__(
        self,
        outbox: Outbox,
        bounds: tuple[int, int | None],
        owner: QueueOwner | None,
        open_topic: OpenTopic,
        put: Put,
    ) -> None:
        super().__init__(outbox, *bounds, owner)
        self._open_topic = open_topic
        self._put = put
        self._feed: Feed | None = None
        self._topic: RecordedTopic | None = None

    def put(self, entry: Entry, *, more: bool = False) -> bool:
        """Record a sample, or have its picture encoded."""
        subscription = cast("Subscription", self.owner)
        if subscription.source is not self._feed:
            self._feed = subscription.source
            self._topic = self._open_topic(subscription)
        topic = self._topic
        if topic is None or self._feed is None:
            self.discarded += 1
            return False
        sample = cast("SharedFrame | PerClientFrame", entry).sample
        received_ns = sample.received_ns or time.time_ns()  # now, if it was retained
        message = RecordedMessage(received_ns, sample.source_ns or received_ns, topic, sample.cdr)
        if self._feed.encoding.image is not None:
            return super().put(_WaitingPicture(entry, message, self._put), more=more)
        self.sent += 1
        self.sent_bytes += len(sample.cdr)
        self._put(message)
        return False

    @property
    def lost(self) -> int:
        """The samples that never came, and those for which no worker was free."""
        owner = cast("Subscription | None", self.owner)
        return self.dropped + (0 if owner is None else owner.lost_before)


class _WaitingPicture:
    """A picture that a worker encodes, recorded when it is ready."""

    def __init__(self, entry: Entry, message: RecordedMessage, put: Put) -> None:
        self._entry = entry
        self._message = message._replace(cdr=b"")
        self._put = put
        self.size = entry.size
        self.arrived_ns = entry.arrived_ns

    @property
    def is_being_encoded(self) -> bool:
        return self._entry.is_being_encoded

    def frame(self) -> Frame:
        frame = self._entry.frame()
        if isinstance(frame, bytes):
            self._put(self._message._replace(cdr=frame))
        return frame


class RecordedOutbox(Outbox):
    """The queues of the recorder."""

    def __init__(self, open_topic: OpenTopic, put: Put) -> None:
        super().__init__(MAX_WAITING_PICTURE_BYTES)
        self._open_topic = open_topic
        self._put = put

    def open_queue(
        self, depth: int, max_bytes: int | None, owner: QueueOwner | None = None
    ) -> Queue:
        """Add a queue."""
        queue = RecordedQueue(self, (depth, max_bytes), owner, self._open_topic, self._put)
        self._queues.append(queue)
        return queue

    @property
    def lost(self) -> int:
        """The samples of all topics that were published and are not recorded."""
        return sum(cast("RecordedQueue", queue).lost for queue in self._queues)


class RecordingSession(Session):
    """The recorder, as the core sees it. It notes why a topic is not recorded."""

    NOT_AUTHENTICATED = "record with a role that may subscribe"

    def __init__(self, core: Router, identity: Identity, outbox: RecordedOutbox) -> None:
        peer = Peer(wake=self._take_pictures, name=NAME, address=NAME, identity=identity)
        super().__init__(core, peer)
        self.outbox = outbox
        self.problems: dict[str, str] = {}  # by topic, the newest one

    def send_refusal(self, error: ProtocolError, request: Request | None) -> None:
        """Note why a topic is not recorded, or not completely."""
        if isinstance(request, Subscribe):
            self.problems[request.topic] = str(error)

    def warn(self, error: ProtocolError, request: Request) -> None:
        """Do the same."""
        self.send_refusal(error, request)

    def inform(self, text: str, request: Request) -> None:
        """Need nothing of it."""

    def alert(self, code: StatusCode, text: str, request: Request) -> None:
        """Ask for none of it."""

    def _take_pictures(self) -> None:
        while self.outbox.take(1):
            pass
