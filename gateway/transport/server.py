# SPDX-License-Identifier: Apache-2.0
"""The server of a robot: it admits clients, answers their requests, and reports on them."""

import asyncio
import contextlib
import ipaddress
import time
from collections.abc import AsyncIterator, Callable, Mapping, Sequence
from functools import partial, reduce
from typing import Any, Final

from websockets.http11 import Request, Response
from websockets.server import ServerProtocol

from gateway.access.permissions import Identity, Policy
from gateway.access.tokens import Tokens
from gateway.access.web_rules import WebRules
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
from gateway.transport.connection import Connection
from gateway.transport.connections import Connections
from gateway.transport.counters import ServerCounters, client_counts, client_state
from gateway.transport.end import ConnectionEnd
from gateway.transport.forwarded import client_address
from gateway.transport.front import ClientSession, Front, Fronts
from gateway.transport.health import FindFaults, Health, counts_of, no_faults
from gateway.transport.http import HttpFront, own_names, page, unauthenticated
from gateway.transport.http_connection import AnswerLater, HttpConnection, PathFront
from gateway.transport.listening import ListenPort
from gateway.transport.scrapes import Scrapes
from gateway.transport.static_files import NO_FILES, StaticFiles, method_of
from gateway.transport.url_options import url_options

MakeAdmission = Callable[[RoomFor, WebRules], Admission]

# Pages of metrics that are waited for, or not taken yet: a few times as many as there are scrapers,
# and 11 MB with 32 clients of 64 topics each.
MAX_PAGES: Final = 8


class Server:
    """The clients of a robot. Several servers may share the connections of a port."""

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
        connections: Connections | None = None,
        base: str = "",
    ) -> None:
        """*base* is the part of the path that comes before every path of this server."""
        self.limits = limits
        self.connections = Connections(limits) if connections is None else connections
        self._trusted_proxies = tuple(map(ipaddress.ip_network, trusted_proxies))
        self._router = router
        self.fronts = fronts
        rules = web_rules or WebRules(own_names())
        by_path: dict[str, AnswerLater] = {"/metrics": self._metrics}
        for front in path_fronts:
            by_path |= dict.fromkeys(front.paths, partial(self._show, front))
        self._http = HttpFront(path, files, rules, self.judged, self.health, by_path, base)
        self._find_faults = find_faults
        self._scrapes = Scrapes(self.state)
        self._path_fronts = path_fronts
        self._counters = ServerCounters()
        self._admission = admission(self.connections.room_for, rules)
        self._version = version
        self._started_s = time.monotonic()
        self._left = ClientCounts()  # of clients that have left

    @contextlib.asynccontextmanager
    async def listening(
        self, hosts: Sequence[str], *ports: ListenPort
    ) -> AsyncIterator[list[list[tuple[str, int]]]]:
        """Serve inside the context. Yield of each port the addresses, all on its port.

        All share the clients, their limits and rules. See `Connections.listening`.
        """
        make = partial(Connection, self)
        async with self.connections.listening(hosts, ports, make, self.tick) as addresses:
            try:
                yield addresses
            finally:
                self.close()

    def tick(self, now_s: float, late_s: float) -> None:
        """Take note of the time, and of how late the loop was."""
        self._counters.late(late_s)
        self._admission.tick(now_s)

    def close(self) -> None:
        """Write no further page of metrics."""
        self._scrapes.close()

    async def close_clients(self, reason: str) -> None:
        """Close the connections of this server, and wait until they are gone."""
        await self.connections.close(self._own, reason)

    def judged(self) -> Health:
        """Return what is wrong with the gateway."""
        limits = self.limits
        clients = len(self.connections.clients())
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
            for each in self._own()
            if each.session is not None
        )
        budgets = self.connections.budgets
        addresses = budgets.in_use()
        counters = self._counters
        entities = self._router.counts()
        return Summary(
            version=self._version,
            uptime_s=time.monotonic() - self._started_s,
            clients=clients,
            addresses=tuple(AddressState(at, own.spent_s, own.pauses) for at, own in addresses),
            totals=reduce(ClientCounts.plus, (each.counts for each in clients), self._left),
            time_s=budgets.spent_s,
            pauses=budgets.pauses,
            sessions=counters.sessions,
            connections=len(self._own()),
            unauthenticated=len(self._admission),
            max_clients=self.limits.max_clients,
            tasks=len(asyncio.all_tasks()),
            entities=entities,
            max_ros_entities=self.limits.max_ros_entities,
            control=self._router.control(),
            shared_names=tuple(self._router.ros.diagnosis.shared_names()),
            handshakes_refused=counters.handshakes_refused.copy(),
            authentication_failures=self._admission.failures.copy(),
            ends=counters.ends.copy(),
            lag=counters.lag.observed(),
            max_lag_s=counters.max_lag_s,
            relayed=self._router.commands.relayed.read(),
        )

    def state(self) -> State:
        """Return the whole state, at one moment."""
        return State(self.summary(), self._router.traffic())

    # For connections

    def of(self, request: Request) -> "Server":
        """Return the server that answers a request: this one."""
        del request
        return self

    def choose(self, offered: Sequence[str]) -> str | None:
        """Return the subprotocol to confirm to a client."""
        return self.fronts.choose(offered)

    def _own(self) -> list[Connection]:
        return [each for each in self.connections if each.server is self]

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
        if sum(each.awaits_page for each in self.connections) >= MAX_PAGES:
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
        authenticate = partial(self._admission.authenticate, connection)
        session = front.open(connection.peer(identity, options, authenticate))
        self._counters.began()
        self._admission.enter(connection, session, request, time.monotonic())
        return session

    def reload(self, tokens: Tokens, policy: Policy) -> None:
        """Go on with other tokens and permissions. See `Admission.reload`.

        Everything that a client has open ends at once. A robot must not wait for a handshake.
        """
        clients: list[tuple[ClientConnection, ClientSession]] = [
            (each, each.session) for each in self._own() if each.session is not None
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
        self.connections.discard(connection)
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
