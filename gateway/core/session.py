# SPDX-License-Identifier: Apache-2.0
"""One client as the core sees it: its limits, its rights, and what it can be told.

A front has a subclass, which makes the bytes of its protocol.
"""

import itertools
from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable
from typing import Any, ClassVar, Final, NamedTuple

from gateway.access.permissions import UNLIMITED, Action, Identity
from gateway.config.limits import Limits
from gateway.core.errors import ProtocolError, StatusCode
from gateway.core.outbox import Outbox
from gateway.core.requests import CallService, ImageFormat, Request, RequestId, SendActionGoal
from gateway.metrics.histogram import Histogram


class Session(ABC):
    """The state of a client, and the answers that it gets.

    The content of its `outbox` is to be sent whenever it calls *wake*. *identity* is ``None`` until
    the client has authenticated, if it must.
    """

    NOT_AUTHENTICATED: ClassVar[str]  # how to authenticate, for a client that has not

    def __init__(
        self, limits: Limits, wake: Callable[[], None], identity: Identity | None = UNLIMITED
    ) -> None:
        self.limits: Final = limits
        self.identity = identity
        self.address = "?"
        self.client = "?"  # address and number, for logs and metrics
        self.latency = Histogram()  # of what its topics sent, see `QueueOwner.has_timed`
        self.outbox = Outbox(limits.send_queue_bytes)
        self.wake = wake
        # takes what work for this client has taken from its time budget: seconds, and the time.
        # Returns whether something is left
        self.spend: Callable[[float, float], bool] = lambda spent_s, now_s: True
        # takes what a large message asks for: to read it has taken enough of this turn
        self.next_turn: Callable[[Callable[[], None]], None] = lambda work: work()
        # for how long the message at hand may have waited until we read it, in seconds
        self.waited_s: Callable[[], float] = lambda: 0.0
        # whether it has control of a command topic: then its input goes before that of others
        self.drives: Callable[[], bool] = lambda: False
        self.received = 0  # messages
        self.refused = 0
        self.is_overtaken = False  # the message at hand, by a `stop` that came later
        self.is_behind = False  # its time budget is spent, and what it has sent waits
        self.reads_ascii_only = False
        # raises ProtocolError if the client may not have one more ROS entity
        self.check_share: Callable[[], None] = lambda: None
        # called with whatever the client's role forbids
        self.on_forbidden: Callable[[ProtocolError, Request], None] = lambda *_: None
        self.image_format: ImageFormat = "jpeg"  # of pictures for which it asks for none
        self.replaced = 0  # of what it deferred, by something newer
        self.deferred: dict[Hashable, DeferredWork] = {}
        self._numbers = itertools.count(1)  # of the calls and goals passed on to this client

    @property
    def identity(self) -> Identity | None:
        """The client's identity, once it is known."""
        return self._identity

    @identity.setter
    def identity(self, identity: Identity | None) -> None:
        self._identity = identity
        # true if an operation may be forbidden, read for every operation
        self.is_restricted = identity is None or not identity.permissions.is_unlimited

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
        self.replaced += key in self.deferred
        self.deferred[key] = DeferredWork(request, work)

    # Answers and messages to the client. A front may leave out those that it has no requests for.

    @abstractmethod
    def refuse(self, error: ProtocolError, request: Request | None = None) -> None:
        """Answer a request that failed. Without one, report the error alone."""

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
