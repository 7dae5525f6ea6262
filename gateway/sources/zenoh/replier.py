# SPDX-License-Identifier: Apache-2.0
"""Servers of services over Zenoh: each request is a query, which waits for its answer."""

import logging
import time
from collections.abc import Callable
from typing import Any, Final

from gateway.sources.source import RosError
from gateway.sources.zenoh.attachment import Attachment, read_attachment
from gateway.sources.zenoh.keys import DataKey, WireError
from gateway.sources.zenoh.queries import WaitingQueries, read_query
from gateway.sources.zenoh.requester import SERVICE_QOS, ZenohEndpoints
from gateway.sources.zenoh.service_forms import ServiceWire, check

# Of requests that cannot be read, the first are in the log.
MAX_NAMED_FAULTS: Final = 8

_logger = logging.getLogger(__name__)

# Sends the response, unless the server is closed. A response to a client that has gone is lost.
Reply = Callable[[bytes], None]
OnRequest = Callable[[bytes, Reply], None]


class ZenohReplier:
    """A server. Of requests that wait for the loop, the oldest make room for newer ones."""

    def __init__(
        self,
        endpoints: ZenohEndpoints,
        wire: ServiceWire,
        name: str,
        on_request: OnRequest,
        *,
        subject: str,
    ) -> None:
        """Create it. The text of its errors begins with *subject*, such as ``service /reset``."""
        self._endpoints, self._wire, self._subject = endpoints, wire, subject
        self._on_request = on_request
        self.has_replied = False
        self.left_out = 0  # requests that cannot be read
        self._queries = WaitingQueries(endpoints.mailbox, self._take)
        self._open: dict[int, Any] = {}  # queries that are not answered
        self._is_closing = self._is_closed = False
        type_hash = endpoints.graph.hash_for("SC", name, wire.type_name, wire.type_hash)
        self._declare(endpoints.session.data_key(name, wire.type_name, type_hash))
        endpoints.servers[self._follow_graph] = None

    def drain(self) -> None:
        """Pass all that has arrived to *on_request*. Called from within that, do nothing."""
        self._queries.drain()

    def close(self) -> None:
        """Pass what has arrived to *on_request*, which must reply within the call. Withdraw it.

        No request comes after. Closing twice is harmless.
        """
        if self._is_closing:
            return
        self._is_closing = True
        try:
            self.drain()
        finally:
            self._is_closed = True
            self._queries.close()
            self._endpoints.servers.pop(self._follow_graph)
            self._endpoints.graph.remove(self._token)
            self._endpoints.session.remove(self._token)
            self._endpoints.outgoing.finish(self._withdraw)

    def _follow_graph(self) -> None:
        """Declare it again for clients that show another hash than those before."""
        graph, wire, before = self._endpoints.graph, self._wire, self._key.type_hash
        type_hash = graph.hash_for("SC", self._key.name, wire.type_name, wire.type_hash, before)
        if type_hash == before:
            return
        graph.remove(self._token)
        self._endpoints.session.remove(self._token)
        self._endpoints.outgoing.finish(self._queryable.undeclare)
        self._declare(self._key._replace(type_hash=type_hash))

    def _declare(self, key: DataKey) -> None:
        self._key, session = key, self._endpoints.session
        self._queryable: Any = session.zenoh.declare_queryable(
            key.text, self._queries.arrive, complete=True
        )
        self._token = session.add_endpoint(self._endpoints.node, "SS", key, SERVICE_QOS)
        self._endpoints.graph.add(self._token)

    def _withdraw(self) -> None:
        """Let those who wait know that no answer comes. On the thread that sends, after answers."""
        self._queryable.undeclare()
        self._queries.drop()
        for query in self._open.values():
            query.drop()

    def _take(self, query: Any) -> None:
        try:
            of_sender, request = read_query(query)
            attachment = read_attachment(of_sender)
            check(self._subject, self._wire.read_request, request)
        except (WireError, RosError) as error:
            self.left_out += 1
            if self.left_out <= MAX_NAMED_FAULTS:
                _logger.warning("%s: a request is left out: %s", self._subject, error)
            query.drop()
            return
        self._open[id(query)] = query
        key = self._key.text  # it may be another one when the answer comes
        self._on_request(request, lambda response: self._reply(response, query, key, attachment))

    def _reply(self, response: bytes, query: Any, key: str, asked: Attachment) -> None:
        if self._is_closed or self._open.pop(id(query), None) is None:
            return
        self.has_replied = True
        answer = asked._replace(source_ns=time.time_ns()).packed

        def send() -> None:
            query.reply(key, response, attachment=answer)
            query.drop()

        self._endpoints.outgoing.send(self._subject, len(response), send)
