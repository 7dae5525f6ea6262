# SPDX-License-Identifier: Apache-2.0
"""One client as the core sees it: its limits, its rights, and what it can be told.

A front has a subclass, which makes the bytes of its protocol.
"""

import itertools
from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Hashable
from typing import Any, ClassVar, Final, NamedTuple, Protocol

from gateway.access.permissions import Action, Identity
from gateway.config.limits import Limits
from gateway.core.errors import ProtocolError, StatusCode
from gateway.core.outbox import Outbox
from gateway.core.peer import Peer
from gateway.core.requests import CallService, ImageFormat, Request, RequestId, SendActionGoal
from gateway.metrics.histogram import Histogram


class Core(Protocol):
    """The part of the router that a session asks about its client."""

    @property
    def limits(self) -> Limits:
        """The limits of each client."""

    @property
    def image_format(self) -> ImageFormat:
        """The format of images for which neither a request nor its client asks for one."""

    def check_share(self, session: "Session") -> None:
        """Raise ProtocolError if the client may not have one more ROS entity."""

    def is_driven_by(self, session: "Session") -> bool:
        """Return whether the client has control of a command topic."""

    def record_forbidden(self, session: "Session", error: ProtocolError, request: Request) -> None:
        """Note what the role of the client forbids."""


class Session(ABC):
    """The state of a client, and the answers that it gets.

    The content of its `outbox` is to be sent whenever it wakes its peer. `identity` is ``None``
    until the client has authenticated, if it must.
    """

    NOT_AUTHENTICATED: ClassVar[str]  # how to authenticate, for a client that has not

    def __init__(self, core: Core, peer: Peer) -> None:
        self._core = core
        self.limits: Final = core.limits
        self.peer: Final = peer
        self.client: Final = peer.name
        self.address: Final = peer.address
        self.turns: Final = peer.turns
        self.wake: Final = peer.wake
        self.image_format: Final = peer.image_format or core.image_format
        self.sign_in(peer.identity)
        self.latency = Histogram()  # of what its topics sent, see `QueueOwner.has_timed`
        self.outbox = Outbox(self.limits.send_queue_bytes)
        self.received = 0  # messages
        self.refused = 0
        self.reads_ascii_only = False
        self.clock_offset_ms: float | None = None  # to the gateway's clock, as the client found it
        self.replaced = 0  # of what it deferred, by something newer
        self.deferred: dict[Hashable, DeferredWork] = {}
        self._numbers = itertools.count(1)  # of the calls and goals passed on to this client

    def sign_in(self, identity: Identity | None) -> None:
        """Give the client other rights from now on."""
        self.identity = identity
        # true if an operation may be forbidden, read for every operation
        self.is_restricted = identity is None or not identity.permissions.is_unlimited

    def set_clock(self, offset_ms: float) -> None:
        """Note what the client adds to its clock to get the gateway's."""
        self.clock_offset_ms = offset_ms

    @property
    def drives(self) -> bool:
        """True if it has control of a command topic: then its input goes before that of others."""
        return self._core.is_driven_by(self)

    def check_share(self) -> None:
        """Raise ProtocolError if the client may not have one more ROS entity."""
        self._core.check_share(self)

    def may(self, action: Action, name: str) -> bool:
        """Return whether the client may do this with a resolved name."""
        if self.identity is None:
            return False
        return not self.is_restricted or self.identity.permissions.may(action, name)

    def sees(self, name: str) -> bool:
        """Return whether a resolved name exists for the client."""
        if self.identity is None:
            return False
        return not self.is_restricted or self.identity.permissions.sees(name)

    def defer(self, key: Hashable, request: Request, work: Callable[[], None]) -> None:
        """Do *work* for a request at the end of this turn, or before one of another kind.

        If another of the same key comes until then, that takes its place: of what is set many
        times only the newest counts.
        """
        self.count_replaced(key in self.deferred)
        self.deferred[key] = DeferredWork(request, work)

    def take_deferred(self) -> Collection["DeferredWork"]:
        """Return what is deferred, and forget it."""
        deferred, self.deferred = self.deferred, {}
        return deferred.values()

    def count_replaced(self, count: int) -> None:
        """Count what waited until something newer took its place."""
        self.replaced += count

    def count_refused(self) -> None:
        """Count a request that failed."""
        self.refused += 1

    def refuse(self, error: ProtocolError, request: Request | None = None) -> None:
        """Answer a request that failed. Without one, report the error alone."""
        self.count_refused()
        if request is not None and error.code == "forbidden":
            self._core.record_forbidden(self, error, request)
        self.send_refusal(error, request)

    # Answers and messages to the client. A front may leave out those that it has no requests for.

    @abstractmethod
    def send_refusal(self, error: ProtocolError, request: Request | None) -> None:
        """Send why a request failed, or an error alone."""

    @abstractmethod
    def warn(self, error: ProtocolError, request: Request) -> None:
        """Warn the client of something that may surprise it but is not a failure."""

    @abstractmethod
    def inform(self, text: str, request: Request) -> None:
        """Report what was done to a client that wants to hear it."""

    @abstractmethod
    def alert(self, code: StatusCode, text: str, request: Request) -> None:
        """Tell a client that has asked for it that a topic is silent, or no longer is."""

    def answer(self, kind: str, request_id: RequestId, **members: Any) -> None:
        """Send the answer to a request of the gateway's own, or what follows it."""
        raise NotImplementedError

    def describe(
        self, request_id: RequestId, example: dict[str, Any] | None, members: dict[str, Any]
    ) -> None:
        """Send a description of a type, with an example of a request that uses it."""
        raise NotImplementedError

    def respond(self, request: CallService, values: dict[str, Any]) -> None:
        """Send the response of a service."""
        raise NotImplementedError

    def finish(self, request: SendActionGoal, values: dict[str, Any], status: int) -> None:
        """Send the result of a goal. *status* is of action_msgs/msg/GoalStatus."""
        raise NotImplementedError

    def feedback_frame(self, request: SendActionGoal, values: dict[str, Any]) -> bytes:
        """Return the bytes of a goal's feedback."""
        raise NotImplementedError

    # The same for requests with `RawValues`

    def respond_raw(self, request: CallService, cdr: bytes) -> None:
        """Send the response of a service."""
        raise NotImplementedError

    def finish_raw(self, request: SendActionGoal, cdr: bytes, status: int) -> None:
        """Send the result of a goal."""
        raise NotImplementedError

    def feedback_raw(self, request: SendActionGoal, cdr: bytes) -> bytes:
        """Return the bytes of a goal's feedback."""
        raise NotImplementedError

    def transform_frame(self, request_id: RequestId, transform: bytes) -> bytes:
        """Return the bytes of a transform of a periodic lookup. *transform* is JSON."""
        raise NotImplementedError

    def pass_call(self, service: str, name: str, args: object) -> str:
        """Pass a call on to the client that provides a service, and return the call's id.

        *service* is resolved, *name* is as the client advertised it.
        """
        raise NotImplementedError

    def pass_goal(self, action: str, name: str, type_name: str, args: object) -> str:
        """Pass a goal on to the client that provides an action, and return the goal's id."""
        raise NotImplementedError

    def pass_cancel(self, name: str, goal_id: str) -> None:
        """Ask the client that provides an action to cancel a goal."""
        raise NotImplementedError


class DeferredWork(NamedTuple):
    """Work that is done at the end of a turn, and the request that is answered if it fails."""

    request: Request
    work: Callable[[], None]
