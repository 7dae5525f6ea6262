# SPDX-License-Identifier: Apache-2.0
"""Services that clients call: of ROS nodes, and rosapi's, which the gateway answers itself."""

from collections.abc import Callable
from typing import Final

from gateway.core.deadline import Deadline
from gateway.core.interface_types import InterfaceTypes
from gateway.core.names import ServiceName, resolve_service
from gateway.core.raw_values import RawValues
from gateway.core.requests import CallService
from gateway.core.rosapi import Rosapi
from gateway.core.service_clients import ServiceClients
from gateway.core.session import Session
from gateway.core.tasks import Tasks

MAX_TIMEOUT_S: Final = 3600.0  # also if a client asks for no limit, by 0


class ServiceCalls:
    """Carries out `call_service`, as many at once as clients ask for."""

    def __init__(
        self,
        types: InterfaceTypes,
        service_clients: ServiceClients,
        rosapi: Callable[[Session], Rosapi],
        *,
        calling: Tasks,
        asking: Tasks,
    ) -> None:
        """*rosapi* is as a client sees it. *calling* is for services of ROS, *asking* for it."""
        self._types = types
        self._service_clients = service_clients
        self._rosapi = rosapi
        self._calling = calling
        self._asking = asking

    def call(self, session: Session, request: CallService) -> None:
        """Call a service. The response, or an error, is sent later.

        Raises:
            ProtocolError: nobody provides it, not with that type, or too many calls wait.
        """
        service = resolve_service(request.service, session.limits.max_name_characters)
        deadline = Deadline.within(_timeout_s(session, request))
        rosapi = self._rosapi(session)
        if rosapi.has(service):
            self._answer(rosapi, session, request, service, deadline)
            return
        service_type = self._types.of_service(service, request.type, session.sees)

        async def call() -> None:
            args = request.args
            if isinstance(args, RawValues):
                called = service, service_type.name, args.cdr, deadline
                session.respond_raw(request, await self._service_clients.call_raw(*called))
                return
            values = await self._service_clients.call(service, service_type, request.args, deadline)
            session.respond(request, values)

        self._calling.start(session, request, call, deadline)

    def _answer(
        self,
        rosapi: Rosapi,
        session: Session,
        request: CallService,
        service: ServiceName,
        deadline: Deadline,
    ) -> None:
        """Answer a call of rosapi, at once if no other node is needed, before anything else."""
        answer = rosapi.answer(service, request.args, request.timeout)
        if isinstance(answer, dict):
            session.respond(request, answer)
            return

        async def ask() -> None:
            session.respond(request, await answer())

        self._asking.start(session, request, ask, deadline)


def _timeout_s(session: Session, request: CallService) -> float:
    if request.timeout is None:
        return session.limits.service_timeout_s
    return min(request.timeout, MAX_TIMEOUT_S) if request.timeout > 0 else MAX_TIMEOUT_S
