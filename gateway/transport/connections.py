# SPDX-License-Identifier: Apache-2.0
"""All connections of this process, whichever robot they are to, and the limits that they share."""

import asyncio
import contextlib
import itertools
import logging
import time
from collections import Counter
from collections.abc import AsyncIterator, Callable, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Final

from gateway.backports import timeout
from gateway.config.limits import Limits
from gateway.transport.admission import ClientConnection
from gateway.transport.close_codes import GOING_AWAY
from gateway.transport.end import EndCause
from gateway.transport.listening import ListenPort, listen
from gateway.transport.time_budget import TimeBudgets

if TYPE_CHECKING:  # it imports this
    from gateway.transport.connection import Connection

logger = logging.getLogger(__name__)

# Sockets during their handshake, which takes milliseconds. Each is cut off after 5 s.
MAX_HANDSHAKES: Final = 64
# Sockets that were rejected, or got a page, and have a second to close.
MAX_LEAVING: Final = 64

MAX_GOODBYE_S: Final = 1.0  # of the 2 s for the whole shutdown

TICK_S: Final = 0.25  # the precision of timeouts. The cost of 4 wake-ups a second is not measurable


class Connections:
    """The open connections, the oldest first. Lives on the event loop's thread."""

    def __init__(self, limits: Limits) -> None:
        self.limits = limits
        self.budgets = TimeBudgets(limits.client_time_share, limits.address_time_share)
        self.numbers: Iterator[int] = itertools.count(1)
        self._open: dict[Connection, None] = {}
        self._one_gone = asyncio.Event()

    def __iter__(self) -> Iterator["Connection"]:
        return iter(self._open)

    def __len__(self) -> int:
        return len(self._open)

    def clients(self) -> list["Connection"]:
        """Return the connections that have become clients."""
        return [each for each in self._open if each.session is not None and each.session.identity]

    def room_for(self, connection: ClientConnection) -> str | None:
        """Return the reason why there is no room for a client, or ``None``."""
        clients, limits = self.clients(), self.limits
        if len(clients) >= limits.max_clients:
            return f"over capacity: at most {limits.max_clients} clients (limits.max_clients)"
        same = sum(other.address == connection.address for other in clients)
        if same >= limits.max_clients_per_address:
            return f"over capacity: {same} clients of one address (limits.max_clients_per_address)"
        return None

    def add(self, connection: "Connection") -> None:
        """Add a connection. If too many are not clients yet, the greediest address loses one."""
        self._open[connection] = None
        half_open = [other for other in self._open if other.is_half_open]
        if len(half_open) > MAX_HANDSHAKES:
            counts = Counter(other.address for other in half_open)
            oldest = max(half_open, key=lambda other: counts[other.address])  # the first of equals
            text = f"no handshake, and {MAX_HANDSHAKES} others wait"
            oldest.abort(EndCause("gateway", "handshake", text))
        leaving = [other for other in self._open if other.is_leaving]
        if len(leaving) > MAX_LEAVING:
            leaving[0].abort()

    def discard(self, connection: "Connection") -> None:
        """Forget a connection that is gone."""
        self._open.pop(connection, None)
        self._one_gone.set()

    @contextlib.asynccontextmanager
    async def listening(
        self,
        hosts: Sequence[str],
        ports: Sequence[ListenPort],
        make_connection: Callable[[], asyncio.BaseProtocol],
        on_tick: Callable[[float, float], None],
    ) -> AsyncIterator[list[list[tuple[str, int]]]]:
        """Listen inside the context. Yield of each port the addresses, all on its port.

        A machine may have no IPv6: all *hosts* but the first may fail. *on_tick* gets the time
        every `TICK_S`, and how late the loop was.

        Raises:
            BindError: the first address or a port cannot be listened on.
        """
        listeners: list[asyncio.Server] = []
        try:
            addresses = [
                await listen(port, hosts, make_connection, self.limits, listeners) for port in ports
            ]
            ticking = asyncio.create_task(self._tick(on_tick))
            try:
                yield addresses
            finally:
                ticking.cancel()
        finally:
            for listener in listeners:
                listener.close()
            await self.close(lambda: self._open, "the gateway is shutting down")

    async def _tick(self, on_tick: Callable[[float, float], None]) -> None:
        while True:
            due_s = time.monotonic() + TICK_S
            await asyncio.sleep(TICK_S)
            now_s = time.monotonic()
            self.budgets.expire(now_s)
            on_tick(now_s, now_s - due_s)
            for connection in list(self._open):
                try:
                    connection.tick(now_s)
                except Exception:  # our fault must not end the keep-alive of others
                    client = {"client": connection.name}
                    logger.exception("keeping the times of a client failed", extra=client)
                    connection.abort(EndCause("gateway", "internal_error", "internal error"))

    async def close(self, which: Callable[[], Iterable["Connection"]], reason: str) -> None:
        """Close connections, and wait until they are gone."""
        for connection in list(which()):
            connection.close(GOING_AWAY, reason)
        with contextlib.suppress(TimeoutError):
            async with timeout(min(self.limits.close_timeout_s, MAX_GOODBYE_S)):
                await self._wait_until_gone(which)
        for connection in list(which()):
            connection.abort()
        await self._wait_until_gone(which)

    async def _wait_until_gone(self, which: Callable[[], Iterable["Connection"]]) -> None:
        while any(True for _ in which()):
            self._one_gone.clear()
            await self._one_gone.wait()
