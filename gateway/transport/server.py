# SPDX-License-Identifier: Apache-2.0
"""The server: it listens, admits clients, applies their timeouts, and closes all at the end."""

import asyncio
import contextlib
import ipaddress
import itertools
import logging
import time
from collections import Counter
from collections.abc import AsyncIterator, Callable, Iterator, Mapping, Sequence
from functools import partial, reduce
from typing import Any, Final

from websockets.http11 import Request, Response
from websockets.server import ServerProtocol

from gateway.access.permissions import Identity, Policy
from gateway.access.tokens import Tokens
from gateway.access.web_rules import WebRules
from gateway.backports import timeout
from gateway.config.limits import Limits
from gateway.core.router import Router
from gateway.faults import Fault
from gateway.metrics.page import CONTENT_TYPE
from gateway.metrics.state import AddressState, ClientCounts, State, Summary
from gateway.transport.admission import (
    Admission,
    ClientConnection,
    NotAdmittedError,
    RoomFor,
    everybody,
)
from gateway.transport.close_codes import GOING_AWAY
from gateway.transport.connection import Connection
from gateway.transport.counters import ServerCounters, client_counts, client_state
from gateway.transport.end import ConnectionEnd, EndCause
from gateway.transport.forwarded import client_address
from gateway.transport.front import ClientSession, Front, Fronts
from gateway.transport.health import FindFaults, Health, counts_of, no_faults
from gateway.transport.http import HttpFront, own_names, page, unauthenticated
from gateway.transport.http_connection import AnswerLater, HttpConnection, PathFront
from gateway.transport.listening import ListenPort, listen
from gateway.transport.scrapes import Scrapes
from gateway.transport.static_files import NO_FILES, StaticFiles, method_of
from gateway.transport.time_budget import TimeBudgets
from gateway.transport.url_options import url_options

MakeAdmission = Callable[[RoomFor, WebRules], Admission]

logger = logging.getLogger(__name__)

# Sockets during their handshake, which takes milliseconds. Each is cut off after 5 s.
MAX_HANDSHAKES: Final = 64
# Sockets that were rejected, or got a page, and have a second to close.
MAX_LEAVING: Final = 64

# Pages of metrics that are waited for, or not taken yet: a few times as many as there are scrapers,
# and 11 MB with 32 clients of 64 topics each.
MAX_PAGES: Final = 8

MAX_GOODBYE_S: Final = 1.0  # of the 2 s for the whole shutdown

TICK_S: Final = 0.25  # the precision of timeouts. The cost of 4 wake-ups a second is not measurable


class Server:
    """The connected clients, and the listening sockets."""

    def __init__(  # noqa: PLR0913  # one argument for each part that it shares
        self,
        router: Router,
        fronts: Fronts,
        *path_fronts: PathFront,
        limits: Limits,
        path: str = "/",
        files: StaticFiles = NO_FILES,
        trusted_proxies: Sequence[str] = (),
        web_rules: WebRules | None = None,
        admission: MakeAdmission = everybody,
        version: str = "",
        find_faults: FindFaults = no_faults,
    ) -> None:
        self.limits = limits
        self.budgets = TimeBudgets(limits.client_time_share, limits.address_time_share)
        self._trusted_proxies = tuple(map(ipaddress.ip_network, trusted_proxies))
        self._router = router
        self.fronts = fronts
        rules = web_rules or WebRules(own_names())
        by_path: dict[str, AnswerLater] = {"/metrics": self._metrics}
        for front in path_fronts:
            by_path |= dict.fromkeys(front.paths, partial(self._show, front))
        self._http = HttpFront(path, files, rules, self.judged, self.health, by_path)
        self._find_faults = find_faults
        self._scrapes = Scrapes(self.state)
        self._path_fronts = path_fronts
        self._counters = ServerCounters()
        self._admission = admission(self._room_for, rules)
        self._version = version
        self.numbers: Iterator[int] = itertools.count(1)
        self._connections: dict[Connection, None] = {}  # the oldest first
        self._started_s = time.monotonic()
        self._all_gone = asyncio.Event()
        self._all_gone.set()
        self._left = ClientCounts()  # of clients that have left

    @contextlib.asynccontextmanager
    async def listening(
        self, hosts: Sequence[str], *ports: ListenPort
    ) -> AsyncIterator[list[list[tuple[str, int]]]]:
        """Serve inside the context. Yield of each port the addresses, all on its port.

        All share the clients, their limits and rules. A machine may have no IPv6: all *hosts* but
        the first may fail.

        Raises:
            BindError: the first address or a port cannot be listened on.
        """
        listeners: list[asyncio.Server] = []
        try:
            addresses = [
                await listen(port, hosts, lambda: Connection(self), self.limits, listeners)
                for port in ports
            ]
            ticking = asyncio.create_task(self._tick())
            try:
                yield addresses
            finally:
                ticking.cancel()
        finally:
            for listener in listeners:
                listener.close()
            self._scrapes.close()
            await self._close_all()

    def judged(self) -> Health:
        """Return what is wrong with the gateway."""
        limits = self.limits
        clients = sum(
            1 for each in self._connections if each.session is not None and each.session.identity
        )
        faults = list(self._find_faults())
        if clients >= limits.max_clients:
            text = f"{clients} clients are connected, the maximum: further clients are refused"
            faults.append(Fault("degraded", text))
        return Health(tuple(faults))

    def health(self) -> Mapping[str, Any]:
        """Return the counts of /healthz."""
        return counts_of(self.summary())

    def summary(self) -> Summary:
        """Return the state of the gateway, without the traffic of its topics."""
        clients = tuple(
            client_state(each.session, each.spending, each.keep_alive.round_trip_s)
            for each in self._connections
            if each.session is not None
        )
        addresses = self.budgets.in_use()
        counters = self._counters
        entities = self._router.counts()
        return Summary(
            version=self._version,
            uptime_s=time.monotonic() - self._started_s,
            clients=clients,
            addresses=tuple(AddressState(at, own.spent_s, own.pauses) for at, own in addresses),
            totals=reduce(ClientCounts.plus, (each.counts for each in clients), self._left),
            time_s=self.budgets.spent_s,
            pauses=self.budgets.pauses,
            sessions=counters.sessions,
            connections=len(self._connections),
            unauthenticated=len(self._admission),
            max_clients=self.limits.max_clients,
            tasks=len(asyncio.all_tasks()),
            entities=entities,
            max_ros_entities=self.limits.max_ros_entities,
            control=self._router.control(),
            shared_names=tuple(self._router.shared_names()),
            handshakes_refused=counters.handshakes_refused.copy(),
            authentication_failures=self._admission.failures.copy(),
            ends=counters.ends.copy(),
            lag=counters.lag.observed(),
            max_lag_s=counters.max_lag_s,
        )

    def state(self) -> State:
        """Return the whole state, at one moment."""
        return State(self.summary(), self._router.traffic())

    # For connections

    def arrive(self, connection: Connection) -> None:
        """Add a connection. If too many are not clients yet, the greediest address loses one."""
        self._connections[connection] = None
        self._all_gone.clear()
        half_open = [other for other in self._connections if other.is_half_open]
        if len(half_open) > MAX_HANDSHAKES:
            counts = Counter(other.address for other in half_open)
            oldest = max(half_open, key=lambda other: counts[other.address])  # the first of equals
            text = f"no handshake, and {MAX_HANDSHAKES} others wait"
            oldest.abort(EndCause("gateway", "handshake", text))
        leaving = [other for other in self._connections if other.is_leaving]
        if len(leaving) > MAX_LEAVING:
            leaving[0].abort()

    def _metrics(
        self, protocol: ServerProtocol, request: Request, connection: HttpConnection
    ) -> Response | None:
        """Have the metrics written for a role, or refuse the request."""
        try:
            _, identity = self._identify(request, connection)
        except NotAdmittedError as error:
            return unauthenticated(protocol, error)
        if method_of(request) == "HEAD":
            return page(protocol, request, None, CONTENT_TYPE)
        if sum(each.awaits_page for each in self._connections) >= MAX_PAGES:
            return protocol.reject(503, f"busy: {MAX_PAGES} others get metrics. Try again later\n")

        def reply(body: bytes | None) -> None:
            if body is None:
                connection.answer(protocol.reject(500, "internal error\n"))
            else:
                connection.answer(page(protocol, request, body, CONTENT_TYPE))

        self._scrapes.ask(identity, reply)
        return None

    def _show(
        self,
        front: PathFront,
        protocol: ServerProtocol,
        request: Request,
        connection: HttpConnection,
    ) -> Response | None:
        """Have a front answer a role, or refuse the request."""
        try:
            address, identity = self._identify(request, connection)
        except NotAdmittedError as error:
            return unauthenticated(protocol, error)
        return front.respond(protocol, request, connection, identity, address)

    def _identify(self, request: Request, connection: HttpConnection) -> tuple[str, Identity]:
        """Return the address and the identity behind an HTTP request."""
        address = self.client_address(connection.address, request)
        return address, self._admission.identify_scraper(connection, address, request.headers)

    def client_address(self, peer: str, request: Request) -> str:
        """Return the address of a client, which may be behind proxies."""
        return client_address(peer, request.headers, self._trusted_proxies)

    def respond(
        self, connection: Connection, protocol: ServerProtocol, request: Request
    ) -> Response | None:
        """Answer an HTTP request. ``None``: the connection gets its `answer` later."""
        return self._http.respond(protocol, request, connection)

    def malformed(self, start: bytes) -> bytes:
        """Return the response to bytes that are not an HTTP request."""
        return self._http.malformed(start)

    def _room_for(self, connection: ClientConnection) -> str | None:
        """Return the reason why there is no room for a client, or ``None``."""
        sessions = [(other, other.session) for other in self._connections]
        clients = [each for each, session in sessions if session and session.identity]
        limits = self.limits
        if len(clients) >= limits.max_clients:
            return f"over capacity: at most {limits.max_clients} clients (limits.max_clients)"
        same = sum(other.address == connection.address for other in clients)
        if same >= limits.max_clients_per_address:
            return f"over capacity: {same} clients of one address (limits.max_clients_per_address)"
        return None

    def enter(self, connection: Connection, front: Front, request: Request) -> ClientSession | None:
        """Open a session for a connection, or reject it."""
        options = url_options(request.path)
        try:
            identity = self._admission.identify(connection, request.headers)
        except NotAdmittedError as error:
            code, reason = options.told(error.status), str(error)
            text = None if code is None else front.rejection(code, reason)
            connection.reject(error.close_code, reason, text)
            return None
        session = front.open(connection.flush, connection.address, identity)
        session.client = connection.name
        options.apply(session)
        self._counters.began()
        self._admission.enter(connection, session, request, time.monotonic())
        return session

    def reload(self, tokens: Tokens, policy: Policy) -> None:
        """Go on with other tokens and permissions. See `Admission.reload`.

        Everything that a client has open ends at once. A robot must not wait for a handshake.
        """
        clients: list[tuple[ClientConnection, ClientSession]] = [
            (each, each.session) for each in self._connections if each.session is not None
        ]
        clients += [each for front in self._path_fronts for each in front.sessions()]
        for session in self._admission.reload(tokens, policy, clients):
            self._router.revoke(session)

    def end_turn(self, session: ClientSession) -> None:
        """Carry out the deferred work of a session."""
        self._router.end_turn(session)

    def left(
        self, connection: Connection, session: ClientSession | None, end: ConnectionEnd
    ) -> None:
        """Close everything that a connection had open."""
        self._connections.pop(connection, None)
        if not self._connections:
            self._all_gone.set()
        self._admission.left(connection, session)
        was_client = session is not None or any(connection in front for front in self._path_fronts)
        try:
            for front in self._path_fronts:
                front.left(connection)
            if session is not None:
                self._left = self._left.plus(client_counts(session))
                self._router.leave(session)
        finally:  # after a robot was stopped
            self._counters.ended(end, was_client=was_client)
            end.log()

    async def _tick(self) -> None:
        while True:
            due_s = time.monotonic() + TICK_S
            await asyncio.sleep(TICK_S)
            now_s = time.monotonic()
            self._counters.late(now_s - due_s)
            self.budgets.expire(now_s)
            self._admission.tick(now_s)
            for connection in list(self._connections):
                try:
                    connection.tick(now_s)
                except Exception:  # our fault must not end the keep-alive of others
                    client = {"client": connection.name}
                    logger.exception("keeping the times of a client failed", extra=client)
                    connection.abort(EndCause("gateway", "internal_error", "internal error"))

    async def _close_all(self) -> None:
        for connection in list(self._connections):
            connection.close(GOING_AWAY, "the gateway is shutting down")
        with contextlib.suppress(TimeoutError):
            async with timeout(min(self.limits.close_timeout_s, MAX_GOODBYE_S)):
                await self._all_gone.wait()
        for connection in list(self._connections):
            connection.abort()
        await self._all_gone.wait()
