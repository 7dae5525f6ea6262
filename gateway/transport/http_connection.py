# SPDX-License-Identifier: Apache-2.0
"""The interface of a connection that asks by plain HTTP, and of a front that answers it."""

from collections.abc import Callable, Collection, Iterable
from typing import Protocol

from websockets.http11 import Request, Response
from websockets.server import ServerProtocol

from gateway.access.permissions import Identity
from gateway.transport.front import ClientSession, HttpSession


class HttpConnection(Protocol):
    """A connection that gets a page later, or images."""

    address: str

    @property
    def is_paused(self) -> bool:
        """True while the socket or the link is full."""

    @property
    def awaits_page(self) -> bool:
        """True until it has accepted the page that it gets later."""

    def answer(self, response: Response) -> None:
        """Send the response to the request, unless the peer is gone."""

    @property
    def name(self) -> str:
        """The address and number, for the log."""

    @property
    def session(self) -> ClientSession | None:
        """The session, while the WebSocket is open."""

    def show(self, viewer: HttpSession) -> None:
        """Let a viewer answer, now or part by part."""

    def write(self, data: bytes) -> None:
        """Send a part of the response, unless the peer is gone."""

    def fail(self, bug: Exception) -> None:
        """Close the connection for a bug of ours."""

    def close(self, code: int, reason: str) -> None:
        """End the connection."""

    is_encrypted: bool  # by TLS

    def limit_messages(self, max_bytes: int) -> None:
        """Accept messages of at most so many bytes from now on."""


AnswerLater = Callable[[ServerProtocol, Request, HttpConnection], Response | None]
"""Answer a request, or do so later: ``None``."""


class PathFront(Protocol):
    """A protocol over plain HTTP, at certain paths."""

    @property
    def paths(self) -> Collection[str]:
        """The paths that it answers."""

    def respond(
        self,
        protocol: ServerProtocol,
        request: Request,
        connection: HttpConnection,
        identity: Identity,
        address: str,
    ) -> Response | None:
        """Answer a request, or do so later: ``None``."""

    def sessions(self) -> Iterable[tuple[HttpConnection, HttpSession]]:
        """Return the connections that are answered part by part, and their sessions."""

    def __contains__(self, connection: object) -> bool:
        """Return whether a connection is among these."""

    def left(self, connection: HttpConnection) -> None:
        """Forget a connection that is gone."""
