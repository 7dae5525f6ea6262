# SPDX-License-Identifier: Apache-2.0
"""Services that clients provide: calls from ROS go to a client, its answers go back."""

import asyncio
import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Final

from gateway.codec.error_text import CodecError
from gateway.codec.types import ServiceType
from gateway.core.errors import NothingThereError, ProtocolError, over_limit
from gateway.core.interface_types import InterfaceTypes
from gateway.core.names import ServiceName, resolve_service
from gateway.core.provided import check_takeover, failure, nodes_of, warn_of_others
from gateway.core.requests import (
    AdvertiseService,
    CallService,
    ServiceResponse,
    UnadvertiseService,
)
from gateway.core.service_clients import encode_values
from gateway.core.session import Session
from gateway.sources.services import Service, ServiceRequest
from gateway.sources.source import Ros, RosError

logger = logging.getLogger(__name__)

# Calls that wait for one client to answer. A client that is so far behind will not catch up.
MAX_PENDING: Final = 64


@dataclass(slots=True)
class PendingCall:
    """A call that a client has to answer."""

    request: ServiceRequest
    deadline: asyncio.TimerHandle


@dataclass(slots=True)
class ClientService:
    """One service of one client."""

    session: Session
    requested_name: str
    type: ServiceType
    service: Service
    pending: dict[str, PendingCall] = field(default_factory=dict)
    closed_because: str | None = None


class ClientServices:
    """Opens and closes ROS services as clients come and go. Every call is answered."""

    def __init__(
        self, ros: Ros, types: InterfaceTypes, is_reserved: Callable[[ServiceName], bool]
    ) -> None:
        """*is_reserved* returns whether the gateway answers a service itself."""
        self._ros = ros
        self._types = types
        self._is_reserved = is_reserved
        self._provided: dict[ServiceName, ClientService] = {}

    @property
    def services(self) -> int:
        """The number of open ROS services."""
        return len(self._provided)

    @property
    def pending(self) -> int:
        """The number of calls that wait for a client's answer."""
        return sum(len(provided.pending) for provided in self._provided.values())

    def count(self, session: Session) -> int:
        """Count the services of a client."""
        return sum(provided.session is session for provided in self._provided.values())

    def advertise(self, session: Session, request: AdvertiseService) -> None:
        """Open a service, or take it over from the client that provides it.

        A client that reconnects must not be locked out by the connection that it lost, so the
        newest wins, as in rosbridge.

        Raises:
            ProtocolError: the name or the type is wrong.
            RosError: ROS refuses it.
        """
        service = resolve_service(request.service, session.limits.max_name_characters)
        if self._is_reserved(service):
            text = f"service {service}: the gateway answers it itself, provide another name"
            raise ProtocolError("bad_name", text)
        service_type = self._types.service(request.type)
        former = self._provided.get(service)
        if former is None and self.count(session) >= session.limits.max_advertisements:
            limit = session.limits.max_advertisements
            raise over_limit(limit, "services provided per client", "max_advertisements")
        if former is None or former.session is not session:
            session.check_share()
        if former is not None:
            check_takeover(session, former.session, service, service_type.name, former.type.name)
            self._close(service, former, "service was provided again")
        others = () if former else self._others(service)
        try:
            self._open(session, service, request.service, service_type)
        except RosError:
            if former is not None:
                self._open(former.session, service, former.requested_name, former.type)
            raise
        if former is not None and former.session is not session:
            text = f"service {service} is provided by another client now"
            former.session.warn(ProtocolError("not_found", text), replace(request, id=None))
        warn_of_others(session, f"service {service}", others, request)
        session.inform(f"providing {service} ({service_type.name})", request)

    def unadvertise(self, session: Session, request: UnadvertiseService) -> None:
        """Close a service. Its callers are answered.

        Raises:
            ProtocolError: this client does not provide it.
        """
        service = resolve_service(request.service, session.limits.max_name_characters)
        self._close(service, self._own(session, service), "service was withdrawn")

    def respond(self, session: Session, response: ServiceResponse) -> None:
        """Send a client's answer to the caller.

        Raises:
            ProtocolError: no call waits for this answer, or its values do not fit the type. Then
                the caller gets a failure.
        """
        service = resolve_service(response.service, session.limits.max_name_characters)
        provided = self._own(session, service)
        pending = provided.pending.pop(str(response.id), None)
        if pending is None:
            text = f"no call of {service} with id {response.id!r} waits for a response"
            raise NothingThereError(text)
        pending.deadline.cancel()
        response_type = provided.type.response
        # roslib and roslibpy send an empty object with every failure
        if not response.result and not (response.values and isinstance(response.values, dict)):
            reason = response.values if isinstance(response.values, str) else "service failed"
            _fail(pending.request, provided.type, reason)
            return
        try:
            cdr = encode_values(response_type, response.values, self._ros.now_ns, "values")
        except ProtocolError:
            reason = "the service's client sent an invalid response"
            _fail(pending.request, provided.type, reason)
            raise
        pending.request.answer(cdr)
        if not response.result:
            text = "a ROS service cannot fail: the caller gets these values"
            session.warn(ProtocolError("bad_request", text), response)

    def leave(self, session: Session) -> None:
        """Close all services of a client. Their callers are answered."""
        for service, provided in list(self._provided.items()):
            if provided.session is session:
                self._close(service, provided, "service's client has left")

    def _others(self, service: ServiceName) -> Sequence[str]:
        """Return the ROS nodes that provide it."""
        if not self._ros.service_types(service):  # which the graph is read for
            return ()
        return nodes_of(service, self._ros.graph().services)

    def _own(self, session: Session, service: ServiceName) -> ClientService:
        provided = self._provided.get(service)
        if provided is None or provided.session is not session:
            raise NothingThereError(f"service {service} is not provided by this client")
        return provided

    def _open(
        self, session: Session, service: ServiceName, requested_name: str, service_type: ServiceType
    ) -> None:
        provided: ClientService

        def on_request(call: ServiceRequest) -> None:
            self._pass_on(service, provided, call)

        opened = self._ros.services.serve(service, service_type.name, on_request)
        provided = self._provided[service] = ClientService(
            session, requested_name, service_type, opened
        )

    def _pass_on(self, service: ServiceName, provided: ClientService, call: ServiceRequest) -> None:
        if provided.closed_because is not None:
            _fail(call, provided.type, provided.closed_because)
            return
        if len(provided.pending) >= MAX_PENDING:
            _fail(call, provided.type, "service's client is busy")
            return
        try:
            args = provided.type.request.decode(call.cdr)
        except CodecError as error:
            _fail(call, provided.type, f"request cannot be read: {error}")
            return
        call_id = provided.session.pass_call(service, provided.requested_name, args)
        deadline = asyncio.get_running_loop().call_later(
            provided.session.limits.service_timeout_s, self._expire, provided, call_id
        )
        provided.pending[call_id] = PendingCall(call, deadline)

    def _expire(self, provided: ClientService, call_id: str) -> None:
        pending = provided.pending.pop(call_id)
        _fail(pending.request, provided.type, "service's client did not answer")
        name = provided.requested_name
        text = f"service {name}: no response in time, the caller received a failure"
        provided.session.warn(ProtocolError("timeout", text), CallService(id=call_id, service=name))

    def _close(self, service: ServiceName, provided: ClientService, reason: str) -> None:
        del self._provided[service]
        provided.closed_because = reason  # calls that have arrived still follow
        for pending in provided.pending.values():
            pending.deadline.cancel()
            _fail(pending.request, provided.type, reason)
        provided.pending.clear()
        provided.service.close()


def _fail(request: ServiceRequest, service_type: ServiceType, reason: str) -> None:
    """Answer a call that has failed. A caller that is gone needs no answer."""
    try:
        request.answer(failure(service_type.response, reason))
    except RosError:
        logger.info("a caller of %s has gone", service_type.name)
