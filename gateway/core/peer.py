# SPDX-License-Identifier: Apache-2.0
"""The connection of a client, as its session needs it."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeAlias

from gateway.access.permissions import UNLIMITED, Identity
from gateway.core.errors import Level
from gateway.core.requests import ImageFormat, Request


class ClientTurns:
    """The turns in which the input of a client is handled. This one never waits for others."""

    is_behind = False  # its time budget is spent, and what it has sent waits
    is_overtaken = False  # the message at hand, by a `stop` that came later
    is_delayed = False  # the message at hand, on its way from a relay, by the clock of this gateway

    def waited_s(self) -> float:
        """Return for how long the message at hand may have waited until it was read."""
        return 0.0

    def next_turn(self, work: Callable[[], None]) -> None:
        """Do *work* later: to read a large message has taken enough of this turn."""
        work()

    def spend(self, spent_s: float, now_s: float) -> bool:
        """Take time from the client's budget. Return whether something is left."""
        del spent_s, now_s
        return True


Authenticate: TypeAlias = Callable[[str | None, Request], None]
"""Takes a token and the request that it came with."""


def _no_token(token: str | None, request: Request) -> None:
    del token, request


@dataclass(frozen=True, slots=True, kw_only=True)
class Peer:
    """The facts about a connection, and the calls that go to it.

    *wake* is called whenever the session's outbox has something to send. *on_unreadable* gets each
    message that was refused because it cannot be read.
    """

    wake: Callable[[], None]
    name: str = "?"  # address and number, for logs and metrics
    address: str = "?"
    identity: Identity | None = UNLIMITED  # None: the client has yet to authenticate
    image_format: ImageFormat | None = None  # of images for which the client asks for none
    level: Level | None = None  # of the reports that it wants
    turns: ClientTurns = field(default_factory=ClientTurns)
    authenticate: Authenticate = _no_token
    on_unreadable: Callable[[bytes], None] = lambda data: None
