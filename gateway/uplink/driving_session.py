# SPDX-License-Identifier: Apache-2.0
"""A client of a relay, as the core of the robot's own gateway sees it."""

from typing import Any, Final

from gateway.access.permissions import Identity
from gateway.core.errors import NothingThereError, ProtocolError, StatusCode
from gateway.core.peer import ClientTurns, Peer
from gateway.core.requests import Publish, Request, RequestId
from gateway.core.session import Core, Session
from gateway.core.token_bucket import TokenBucket
from gateway.sources.zenoh.driving_wire import (
    MAX_EVENTS,
    MAX_TEXT_CHARACTERS,
    RemoteCommand,
    ToldEvent,
)

# XR drives at 120 Hz. Faster commands are dropped unread.
COMMANDS_PER_S: Final = 250.0
MAX_COMMANDS_AT_ONCE: Final = 50  # as after a short stall


class RemoteTurns(ClientTurns):
    """The way of the command at hand, by its relay and by the robot's clock."""

    def __init__(self) -> None:
        self.is_behind = False
        self.is_delayed = False
        self._waited_s = 0.0

    def take(self, command: RemoteCommand, *, is_delayed: bool) -> None:
        """Begin with a command."""
        self.is_behind = command.is_behind
        self.is_delayed = is_delayed
        self._waited_s = command.waited_ms / 1000

    def waited_s(self) -> float:
        """Return for how long the command may have waited at the relay."""
        return self._waited_s


class RemoteSession(Session):
    """One client of a relay. Answers to it wait until `take_events`.

    It has a token at the relay, by which the robot knows that the relay has not lost it.
    """

    NOT_AUTHENTICATED = "drive with a role that may publish"

    def __init__(self, core: Core, client: str, who: Identity, address: str, now_ns: int) -> None:
        self.of_commands: Final = RemoteTurns()
        peer = Peer(
            wake=_nothing_waits,
            name=f"{address or '?'} over relay {client}",
            address=address or "relay",
            identity=who,
            turns=self.of_commands,
        )
        super().__init__(core, peer)
        self._number = 0  # the greatest that has come
        self.entered_ns: Final = now_ns
        self.active_ns = now_ns
        self.has_token = False
        self._bucket = TokenBucket(COMMANDS_PER_S, MAX_COMMANDS_AT_ONCE, now_ns)
        self._events: list[ToldEvent] = []

    def is_newest(self, number: int) -> bool:
        """Note the number of a command or an operation. Return whether it is greater than all."""
        is_newest, self._number = number > self._number, max(number, self._number)
        return is_newest

    def follow_token(self, *, is_there: bool) -> None:
        """Note whether its token is there."""
        self.has_token = is_there

    def note_active(self, now_ns: int) -> None:
        """Note that it has sent something."""
        self.active_ns = now_ns

    def has_budget(self, now_ns: int) -> bool:
        """Count a message. Return whether it may be read."""
        self.received += 1
        self.note_active(now_ns)
        return self._bucket.allow(now_ns)

    def take_events(self) -> tuple[ToldEvent, ...]:
        """Return what the client is to be told, and forget it."""
        events, self._events = tuple(self._events), []
        return events

    def send_refusal(self, error: ProtocolError, request: Request | None) -> None:
        """Send it, unless the relay has told its client already."""
        if isinstance(request, Publish) and request.msg is None:
            return
        is_warning = isinstance(error, NothingThereError)
        self._report("refusal", error, request, is_warning=is_warning)

    def warn(self, error: ProtocolError, request: Request) -> None:
        """Send it."""
        self._report("warning", error, request)

    def inform(self, text: str, request: Request) -> None:
        """Send it."""
        self._tell(ToldEvent(what="info", number=_number(request), text=_cut(text)))

    def alert(self, code: StatusCode, text: str, request: Request) -> None:
        """Ask for none of it."""

    def answer(self, kind: str, request_id: RequestId, **members: Any) -> None:
        """Send it. States that change without a request reach the relay once for all clients."""
        if request_id is None and "clamped" not in members:
            return
        number = request_id if isinstance(request_id, int) else None
        self._tell(ToldEvent(what="answer", number=number, kind=kind, members=members))

    def _report(
        self, what: str, error: ProtocolError, request: Request | None, *, is_warning: bool = False
    ) -> None:
        event = ToldEvent(
            what="refusal" if what == "refusal" else "warning",
            number=_number(request),
            code=error.code,
            text=_cut(str(error)),
            is_warning=is_warning,
        )
        self._tell(event)

    def _tell(self, event: ToldEvent) -> None:
        if len(self._events) < MAX_EVENTS:
            self._events.append(event)


def _number(request: Request | None) -> int | None:
    return request.id if request is not None and isinstance(request.id, int) else None


def _cut(text: str) -> str:
    return text[:MAX_TEXT_CHARACTERS]


def _nothing_waits() -> None:
    """Do nothing: nothing is put into the outbox."""
