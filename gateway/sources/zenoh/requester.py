# SPDX-License-Identifier: Apache-2.0
"""Clients of services over Zenoh: each request is a query to the servers of its key."""

import asyncio
import itertools
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Final

import zenoh

from gateway.sources.requester import Requester
from gateway.sources.source import Qos, RosError
from gateway.sources.zenoh.attachment import Attachment
from gateway.sources.zenoh.events import REMEDY
from gateway.sources.zenoh.keys import NO_TYPE_HASH, DataKey
from gateway.sources.zenoh.outgoing import Mailbox, Outgoing
from gateway.sources.zenoh.service_forms import ServiceWire
from gateway.sources.zenoh.session import ZenohSession
from gateway.sources.zenoh.token_graph import TokenGraph
from gateway.sources.zenoh.tokens import gid_of

# The routers forget a query after this time, whose caller has given up long before. It is that of
# rmw_zenoh's configuration.
QUERY_S: Final = 600.0
SERVICE_QOS: Final = Qos("reliable", "volatile", "keep_last", 10)


# The token of a server that ends goes soon after its queries: then it has gone.
LISTED_S: Final = 1.0
MAX_ERROR_BYTES: Final = 200  # of what a server says


@dataclass(frozen=True, slots=True)
class ZenohEndpoints:
    """The parts that the clients and servers of one node have in common."""

    session: ZenohSession
    node: str
    graph: TokenGraph
    mailbox: Mailbox
    outgoing: Outgoing
    loop: asyncio.AbstractEventLoop
    # called when nodes have come or gone
    servers: dict[Callable[[], None], None] = field(default_factory=dict)


class ZenohRequester(Requester):
    """A client with any number of requests under way. Servers are known by their tokens."""

    def __init__(
        self,
        endpoints: ZenohEndpoints,
        wire: ServiceWire,
        name: str,
        *,
        subject: str,
        query_s: float = QUERY_S,
        **options: Any,
    ) -> None:
        """Create it. *options* are those of `Requester`."""
        super().__init__(
            endpoints.loop, subject=subject, find_conflict=self._refuse_other_version, **options
        )
        self._endpoints, self._wire = endpoints, wire
        self._query_s = query_s
        self._numbers = itertools.count(1)
        type_hash = endpoints.graph.hash_for("SS", name, wire.type_name, wire.type_hash)
        self._declare(endpoints.session.data_key(name, wire.type_name, type_hash))
        self._queries: dict[int, Any] = {}  # which can be cancelled

    def follow_graph(self) -> None:
        """Follow servers that have come or gone, also those that show no hashes of types."""
        name, graph = self._key.name, self._endpoints.graph
        type_hash = graph.hash_for(
            "SS", name, self._wire.type_name, self._wire.type_hash, self._key.type_hash
        )
        if type_hash != self._key.type_hash and not self._under_way and not self._is_closed:
            self._destroy()
            self._declare(self._key._replace(type_hash=type_hash))
        super().follow_graph()

    def _declare(self, key: DataKey) -> None:
        self._key, session = key, self._endpoints.session
        self._querier: Any = session.zenoh.declare_querier(
            key.text,
            target=zenoh.QueryTarget.ALL_COMPLETE,
            consolidation=zenoh.ConsolidationMode.NONE,
            timeout=self._query_s,
        )
        self._token = session.add_endpoint(self._endpoints.node, "SC", key, SERVICE_QOS)
        self._endpoints.graph.add(self._token)
        self._gid = gid_of(self._token)

    def _has_server(self) -> bool:
        if self._find_servers():
            # the token may come before the way to its server
            return bool(self._querier.matching_status.matching)
        return self._has_other_version()

    def _find_servers(self) -> frozenset[bytes]:
        servers = self._endpoints.graph.endpoints("SS", self._key.name)
        return frozenset(each.gid for each in servers if each.key == self._key)

    def _has_other_version(self) -> bool:
        return any(
            each.key.type_name == self._key.type_name and each.key.type_hash != NO_TYPE_HASH
            for each in self._endpoints.graph.endpoints("SS", self._key.name)
        )

    def _refuse_other_version(self, servers: frozenset[bytes]) -> RosError | None:
        if servers:
            return None
        problem = f"its server has another definition of {self._key.type_name} than this gateway"
        text = f"{self._subject}: {problem}, so it is not called: {REMEDY}"
        return RosError("type_conflict", text)

    def _transmit(self, request: bytes) -> int:
        number = next(self._numbers)
        attachment = Attachment(number, time.time_ns(), self._gid).packed
        cancellation = zenoh.CancellationToken()
        mailbox = self._endpoints.mailbox
        is_first = iter((True,))  # a peer may answer without end
        errors: list[str] = []  # the first is kept, and counts if no other server answers

        def arrive(reply: Any) -> None:  # on a thread of Zenoh
            answer = reply.ok
            if answer is None:
                errors[1:] = [_text_of(reply.err)]
            elif next(is_first, False):
                cdr = answer.payload.to_bytes()
                mailbox.put(lambda: self._settle(number, cdr))

        # On the thread that receives: by default, each request has its own.
        handler = zenoh.handlers.Callback(
            arrive, lambda: mailbox.put(lambda: self._over(number, errors)), indirect=False
        )

        def send() -> None:
            self._querier.get(
                handler=handler,
                payload=request,
                attachment=attachment,
                cancellation_token=cancellation,
            )

        self._endpoints.outgoing.send(self._subject, len(request), send)
        self._queries[number] = cancellation
        return number

    def _over(self, number: int, errors: list[str]) -> None:
        """Fail a request whose query has ended without an answer."""
        self._queries.pop(number, None)
        request = self._under_way.get(number)
        if request is None:
            return
        if errors:
            why = f"{self._subject}: the server answers with an error, {errors[0]!r}"
            self._fail(request.response, RosError("internal", f"{why}: look at its log"))
        elif request.servers & self._find_servers():
            self._endpoints.loop.call_later(LISTED_S, self._fail, request.response, self._refused())
        else:
            self._fail(request.response, self._gone())

    def _refused(self) -> RosError:
        why = f"{self._subject}: no answer comes, although its server is listed"
        remedy = "look at its log, and at the access control of the Zenoh router"
        return RosError("internal", f"{why}: {remedy}")

    def _end(self, number: int) -> None:
        super()._end(number)
        cancellation = self._queries.pop(number, None)
        if cancellation is not None:
            cancellation.cancel()

    def _take(self) -> None:
        self._endpoints.mailbox.deliver()

    def _destroy(self) -> None:
        self._endpoints.graph.remove(self._token)
        self._endpoints.session.remove(self._token)
        self._endpoints.outgoing.finish(self._querier.undeclare)


def _text_of(error: Any) -> str:
    """Return what a server says of an error. It may be anything."""
    said: str = error.payload.to_bytes()[:MAX_ERROR_BYTES].decode("utf-8", "replace")
    return said
