# SPDX-License-Identifier: Apache-2.0
"""Services that clients call: of ROS nodes, and rosapi's, which the gateway answers itself."""

import asyncio
from typing import Final

from gateway.protocol import messages
from gateway.protocol.errors import ProtocolError
from gateway.protocol.names import ServiceName, resolve_service
from gateway.protocol.operations.services import CallService
from gateway.protocol.session import Session
from gateway.rosapi import Rosapi
from gateway.router.interface_types import InterfaceTypes
from gateway.router.tasks import Tasks
from gateway.service_clients import ServiceClients

MAX_TIMEOUT_S: Final = 3600.0  # also where a client says for ever, by 0


class ServiceCalls:
    """Carries out `call_service`, as many at once as clients ask for."""

    def __init__(
        self,
        types: InterfaceTypes,
        service_clients: ServiceClients,
        rosapi: Rosapi,
        *,
        calling: Tasks,
        asking: Tasks,
    ) -> None:
        """*calling* is for services of ROS, *asking* for rosapi's."""
        self._types = types
        self._service_clients = service_clients
        self._rosapi = rosapi
        self._calling = calling
        self._asking = asking

    def call(self, session: Session, request: CallService) -> None:
        """Call a service; its response, or why there is none, comes when it comes.

        Raises:
            ProtocolError: nobody provides it, not with that type, or too many calls wait.
        """
        service = resolve_service(request.service, session.limits.name_characters)
        loop = asyncio.get_running_loop()
        timeout_s = _timeout_s(session, request)
        deadline = loop.time() + timeout_s
        if self._rosapi.has(service):
            # What needs no other node is answered at once, before the client's next operation.
            local = self._rosapi.answer(service, request.args, request.timeout)
            if isinstance(local, dict):
                _respond(session, request, local)
                return
            ask = local

            async def work() -> None:
                _respond(session, request, await ask())

            self._asking.start(session, request, work, timeout_s)
            return
        type_name = self._type(session, service, request)

        async def call() -> None:
            left_s = deadline - loop.time()
            try:
                values = await self._service_clients.call(service, type_name, request.args, left_s)
            except ProtocolError as error:
                if error.code != "timeout":
                    raise
                text = f"service {service} has not answered within {timeout_s:g} s"
                raise ProtocolError("timeout", text) from None
            _respond(session, request, values)

        self._calling.start(session, request, call, timeout_s)

    def _type(self, session: Session, service: ServiceName, request: CallService) -> str:
        """Return the type that the service has; another one that the client names is a warning.

        rosbridge does not look at it, so many a page names a wrong one and has never noticed.
        """
        try:
            return self._types.of_service(service, request.type).name
        except ProtocolError as error:
            if error.code not in {"type_conflict", "bad_type"} or request.type is None:
                raise
            found = self._types.of_service(service, None).name
            warning = ProtocolError(error.code, f"{error}; calling it all the same")
            session.warn(warning, request.op, request.id)
            return found


def _timeout_s(session: Session, request: CallService) -> float:
    if request.timeout is None:
        return session.limits.service_timeout_s
    return min(request.timeout, MAX_TIMEOUT_S) if request.timeout > 0 else MAX_TIMEOUT_S


def _respond(session: Session, request: CallService, values: dict[str, object]) -> None:
    frame = messages.service_response(request.service, request.id, values, result=True)
    session.send(frame, request.fragment_size)
