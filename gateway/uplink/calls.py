# SPDX-License-Identifier: Apache-2.0
"""Calls that relays make through the uplink: services of the robot, its actions, its types.

One queryable takes all of them. The core carries them out, with the role of the uplink.
"""

import logging
import time
from typing import TYPE_CHECKING, Any, Final, cast

from gateway.codec.error_text import CodecError
from gateway.core.errors import ProtocolError
from gateway.core.raw_values import RawValues
from gateway.core.requests import CallService
from gateway.sources.source import RosError
from gateway.sources.zenoh.attachment import Attachment, read_attachment
from gateway.sources.zenoh.keys import DataKey, WireError, parse_key
from gateway.sources.zenoh.queries import WaitingQueries, read_query
from gateway.uplink.actions import BEHIND_ACTION, UplinkActions
from gateway.uplink.descriptions import description_of
from gateway.uplink.offer import DESCRIBE_TYPE, DOMAIN

if TYPE_CHECKING:
    from gateway.uplink.link import UplinkLink

# The time limit of a call: relays have theirs, and do not say it.
CALL_S: Final = 60.0
# Of requests that cannot be read, the first are in the log.
MAX_NAMED_REQUESTS: Final = 8

_logger = logging.getLogger(__name__)


class RemoteQuery:
    """A request of a relay. It is answered once, on the thread that sends."""

    def __init__(self, link: "UplinkLink", query: Any, key: DataKey, asked: Attachment) -> None:
        self._link, self._query, self._asked = link, query, asked
        self.key = key

    def reply(self, cdr: bytes) -> None:
        """Send the response. If too much waits, the caller gets none."""
        attachment = self._asked._replace(source_ns=time.time_ns()).packed
        query, key = self._query, self.key.text
        self._send(len(cdr), lambda: query.reply(key, cdr, attachment=attachment))

    def refuse(self, text: str) -> None:
        """Send the reason why there is no response."""
        query, data = self._query, text.encode()
        self._send(len(data), lambda: query.reply_err(data))

    def drop(self) -> None:
        """Leave the request to others."""
        self._query.drop()

    def _send(self, size: int, send: Any) -> None:
        query = self._query

        def answer() -> None:
            try:
                send()
            finally:
                query.drop()

        try:
            self._link.outgoing.send(f"service {self.key.name}", size, answer)
        except RosError as error:
            _logger.warning("an answer is lost: %s", error)
            query.drop()
        else:
            self._link.pace.sent(size)
            self._link.pace.mark()


class UplinkCalls:
    """Gives each request of a relay to the part that carries it out."""

    def __init__(self, link: "UplinkLink") -> None:
        self._link = link
        self.left_out = 0  # requests that cannot be read
        self.actions = UplinkActions(link)
        self._queries = WaitingQueries(link.mailbox, self._take)
        link.outgoing.finish(self._listen)

    def close(self) -> None:
        """Take no more. Goals end."""
        self._queries.close()
        self._queries.drop()
        self.actions.close()

    def _listen(self) -> None:  # on the thread
        queryable = self._link.opened.zenoh.declare_queryable(
            f"{DOMAIN}/**", self._queries.arrive, complete=True
        )
        self._link.opened.kept.append(queryable)

    def _take(self, query: Any) -> None:
        try:
            key = parse_key(str(query.key_expr))
            of_sender, cdr = read_query(query)
            remote = RemoteQuery(self._link, query, key, read_attachment(of_sender))
        except WireError as error:
            self.left_out += 1
            if self.left_out <= MAX_NAMED_REQUESTS:
                _logger.warning("a request of a relay is left out: %s", error)
            query.drop()
            return
        try:
            self._carry_out(remote, cdr)
        except CodecError as error:
            remote.refuse(f"service {key.name}: {error}")

    def _carry_out(self, remote: RemoteQuery, cdr: bytes) -> None:
        link, key = self._link, remote.key
        if BEHIND_ACTION in key.name:
            self.actions.take(remote, cdr)
            return
        is_of_types = key.type_name == DESCRIBE_TYPE
        if not is_of_types and link.offer.services.get(key.name) != key.type_name:
            remote.drop()  # of another participant, or gone
            return
        if key != link.offering.service_key(key.name, key.type_name):
            text = f"the robot has another definition of {key.type_name} than the relay"
            remote.refuse(f"service {key.name}: {text}: give both the same packages")
            return
        service_type = link.types.service(key.type_name)
        # the server may end if it gets something else
        values = cast("dict[str, Any]", service_type.request.decode(cdr))
        if is_of_types:
            described = description_of(link.types.definitions, values)
            remote.reply(service_type.response.encode(described, 0))
            return
        request = CallService(
            service=key.name,
            type=key.type_name,
            args=RawValues(cdr),
            timeout=CALL_S,
            form=_RemoteCall(remote),
        )
        link.core.carry_out(link.session, request)


class _RemoteCall:
    """A call that the core carries out. See `gateway.uplink.session.RemoteRequest`."""

    def __init__(self, remote: RemoteQuery) -> None:
        self._remote = remote

    def take(self, cdr: bytes, _: int) -> None:
        self._remote.reply(cdr)

    def feed(self, cdr: bytes) -> None:
        raise NotImplementedError

    def refuse(self, error: ProtocolError) -> None:
        self._remote.refuse(str(error))
