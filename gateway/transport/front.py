# SPDX-License-Identifier: Apache-2.0
"""The interface of a protocol that is spoken on the port."""

from abc import abstractmethod
from collections.abc import Sequence
from typing import Protocol

from gateway.core.errors import StatusCode
from gateway.core.peer import Peer
from gateway.core.router import Router
from gateway.core.session import Session
from gateway.errors import ConfigError
from gateway.interfaces import check_interface, name_of


class ClientSession(Session):
    """The session of a client behind a socket."""

    @abstractmethod
    def is_stop(self, data: bytes) -> bool:
        """Return whether a message is a `stop`, which may go before the ones that came earlier."""


class HttpSession(ClientSession):
    """The session of a request by plain HTTP that is answered part by part."""

    @abstractmethod
    def flush(self) -> None:
        """Send what waits, if the socket takes it."""

    @abstractmethod
    def tick(self, now_s: float) -> None:
        """Note the time."""


class Front(Protocol):
    """A protocol: it opens a session for each client, and reads its messages."""

    @property
    def subprotocols(self) -> Sequence[str]:
        """The subprotocols of the WebSocket by which clients choose this front."""

    def open(self, peer: Peer) -> ClientSession:
        """Open a session for a client."""

    def rejection(self, code: StatusCode, reason: str) -> bytes:
        """Return the message to a client that is rejected before it has a session."""

    def receive(self, session: ClientSession, data: bytes) -> None:
        """Carry out one message of a client. Every error is answered."""


def checked_front(front: Front, core: Router) -> Front:
    """Return a front, once it has opened a session on trial.

    Raises:
        ConfigError: it, or its session, lacks a method.
    """
    check_interface("front", front, Front)
    try:
        session = front.open(Peer(wake=lambda: None))
        session.NOT_AUTHENTICATED  # noqa: B018  # which is looked up when it is needed
    except (TypeError, AttributeError) as error:
        text = f"--front: {name_of(front)} cannot open a session, {error}"
        raise ConfigError(f"{text}: complete its subclass of ClientSession") from error
    core.leave(session)
    return front


class Fronts:
    """The fronts of one port. A client chooses by its subprotocol, and the first is the default."""

    def __init__(self, first: Front, *others: Front) -> None:
        """Raise ConfigError if a client could not choose one of them."""
        self._first = first
        self._by_subprotocol: dict[str, Front] = {}
        for front in (first, *others):
            if not front.subprotocols:
                text = f"--front: {name_of(front)} has no subprotocol, so no client could choose it"
                raise ConfigError(f"{text}: name one in its `subprotocols`")
            for each in front.subprotocols:
                other = self._by_subprotocol.setdefault(each, front)
                if other is not front:
                    text = f"--front: {name_of(other)} and {name_of(front)} both have subprotocol"
                    raise ConfigError(f"{text} {each!r}: leave out one of them, or rename it there")

    def choose(self, offered: Sequence[str]) -> str | None:
        """Return the subprotocol to confirm: the first that a front has, or ``None``."""
        return next((each for each in offered if each in self._by_subprotocol), None)

    def of(self, subprotocol: str | None) -> Front:
        """Return the front of a client, by the subprotocol that was confirmed."""
        return self._first if subprotocol is None else self._by_subprotocol[subprotocol]
