# SPDX-License-Identifier: Apache-2.0
"""The states of the command topics, as all relays get them."""

from collections.abc import Callable
from typing import Any

from gateway.access.permissions import Identity
from gateway.core.errors import ProtocolError, StatusCode
from gateway.core.peer import Peer
from gateway.core.requests import Control, Request, RequestId
from gateway.core.router import Router
from gateway.core.session import Session

NAME = "uplink"  # in metrics


class ControlObserver(Session):
    """A client of the core that follows every command topic its role sees, and never drives."""

    NOT_AUTHENTICATED = "follow with a role that sees the topic"

    def __init__(self, router: Router, identity: Identity, on_change: Callable[[], None]) -> None:
        peer = Peer(wake=_nothing_waits, name=NAME, address=NAME, identity=identity)
        super().__init__(router, peer)
        self._router = router
        self._on_change = on_change
        self._members: dict[str, dict[str, Any]] = {}  # by topic
        self._router.enter(self)
        self._ask(watch=True)

    def states(self) -> dict[str, dict[str, Any]]:
        """Return the fields of a `control` frame for each topic, except topic and holder."""
        self._ask()
        return self._members

    def send_refusal(self, error: ProtocolError, request: Request | None) -> None:
        """Leave out a topic that the role does not see."""
        if isinstance(request, Control) and request.topic is not None:
            self._members.pop(request.topic, None)

    def warn(self, error: ProtocolError, request: Request) -> None:
        """Need nothing of it."""

    def inform(self, text: str, request: Request) -> None:
        """Need nothing of it."""

    def alert(self, code: StatusCode, text: str, request: Request) -> None:
        """Ask for none of it."""

    def answer(self, kind: str, request_id: RequestId, **members: Any) -> None:
        """Note a state. One that has changed without a question is reported."""
        topic, _ = members.pop("topic"), members.pop("holder")
        self._members[topic] = members
        if request_id is None:
            self._on_change()

    def _ask(self, watch: bool | None = None) -> None:
        for drive in self._router.commands.control_state().drives:
            request = Control(id=0, topic=drive.topic, watch=watch)
            self._router.carry_out(self, request)


def _nothing_waits() -> None:
    """Do nothing: nothing is put into the outbox."""
