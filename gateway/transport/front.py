# SPDX-License-Identifier: Apache-2.0
"""The interface of a protocol that is spoken on the port."""

from abc import abstractmethod
from collections.abc import Callable, Sequence
from typing import Protocol

from gateway.access.permissions import Identity
from gateway.config.limits import Limits
from gateway.core.errors import Level, StatusCode
from gateway.core.requests import Request
from gateway.core.session import Session
from gateway.errors import ConfigError


class ClientSession(Session):
    """The session of a client behind a socket."""

    def __init__(self, limits: Limits, wake: Callable[[], None], identity: Identity | None) -> None:
        super().__init__(limits, wake, identity)
        # takes a token and the request that it came with, if clients have to show one
        self.authenticate: Callable[[str | None, Request], None] = lambda token, request: None
        # called with each message that cannot be read, once it is refused
        self.on_unreadable: Callable[[bytes], None] = lambda data: None

    @abstractmethod
    def is_stop(self, data: bytes) -> bool:
        """Return whether a message is a `stop`, which may go before the ones that came earlier."""

    @abstractmethod
    def set_level(self, level: Level) -> None:
        """Report only what is of this severity or worse."""


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

    def open(
        self, wake: Callable[[], None], address: str, identity: Identity | None
    ) -> ClientSession:
        """Open a session. It calls *wake* whenever its outbox has something to send.

        *identity* is ``None`` for a client that has yet to authenticate.
        """

    def rejection(self, code: StatusCode, reason: str) -> bytes:
        """Return the message to a client that is rejected before it has a session."""

    def receive(self, session: ClientSession, data: bytes) -> None:
        """Carry out one message of a client. Every error is answered."""


class Fronts:
    """The fronts of one port. A client chooses by its subprotocol, and the first is the default."""

    def __init__(self, first: Front, *others: Front) -> None:
        """Raise ConfigError if a client could not choose one of them."""
        self._first = first
        self._by_subprotocol: dict[str, Front] = {}
        for front in (first, *others):
            if not front.subprotocols:
                text = f"--front: {_name(front)} has no subprotocol, so no client could choose it"
                raise ConfigError(f"{text}: name one in its `subprotocols`")
            for each in front.subprotocols:
                other = self._by_subprotocol.setdefault(each, front)
                if other is not front:
                    text = f"--front: {_name(other)} and {_name(front)} both have subprotocol"
                    raise ConfigError(f"{text} {each!r}: leave out one of them, or rename it there")

    def choose(self, offered: Sequence[str]) -> str | None:
        """Return the subprotocol to confirm: the first that a front has, or ``None``."""
        return next((each for each in offered if each in self._by_subprotocol), None)

    def of(self, subprotocol: str | None) -> Front:
        """Return the front of a client, by the subprotocol that was confirmed."""
        return self._first if subprotocol is None else self._by_subprotocol[subprotocol]


def _name(front: Front) -> str:
    return f"{type(front).__module__}:{type(front).__name__}"
