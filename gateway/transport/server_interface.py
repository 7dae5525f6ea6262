# SPDX-License-Identifier: Apache-2.0
"""A connection's interface to the server that accepted it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Protocol

from websockets.http11 import Request, Response
from websockets.server import ServerProtocol

from gateway.config.limits import Limits
from gateway.transport.end import ConnectionEnd
from gateway.transport.front import ClientSession, Front, Fronts
from gateway.transport.time_budget import TimeBudgets

if TYPE_CHECKING:  # it imports this
    from gateway.transport.connection import Connection


class ServerInterface(Protocol):
    """The part of the server that a connection needs."""

    limits: Limits
    fronts: Fronts
    budgets: TimeBudgets
    numbers: Iterator[int]  # of connections

    def arrive(self, connection: Connection) -> None:
        """Add a new connection, which may end another."""

    def client_address(self, peer: str, request: Request) -> str:
        """Return the address of a client, which may be behind proxies."""

    def respond(
        self, connection: Connection, protocol: ServerProtocol, request: Request
    ) -> Response | None:
        """Answer an HTTP request: 101 to continue as a WebSocket, else a page or a refusal.

        ``None`` means that the connection gets its `answer` later.
        """

    def malformed(self, start: bytes) -> bytes:
        """Return the response to bytes that begin like this and are not an HTTP request."""

    def enter(self, connection: Connection, front: Front, request: Request) -> ClientSession | None:
        """Open the session of a client after its handshake, or ``None`` if it was rejected."""

    def end_turn(self, session: ClientSession) -> None:
        """Carry out work that was deferred until the others have had their turn."""

    def left(
        self, connection: Connection, session: ClientSession | None, end: ConnectionEnd
    ) -> None:
        """Forget a connection that is gone."""
