# SPDX-License-Identifier: Apache-2.0
"""Services that clients call: of ROS nodes, and rosapi's, which the gateway answers itself."""

from functools import partial
from typing import Final

from gateway.calls import Calls
from gateway.protocol import frames
from gateway.protocol.names import resolve_service
from gateway.protocol.operations.services import CallService
from gateway.protocol.session import Session
from gateway.rosapi import Rosapi
from gateway.router.interface_types import InterfaceTypes
from gateway.router.tasks import Tasks

MAX_TIMEOUT_S: Final = 3600.0  # even where a client says for ever


class ServiceCalls:
    """Carries out `call_service`, as many at once as clients ask for."""

    def __init__(self, types: InterfaceTypes, calls: Calls, rosapi: Rosapi, tasks: Tasks) -> None:
        self._types = types
        self._calls = calls
        self._rosapi = rosapi
        self._tasks = tasks

    def call(self, session: Session, request: CallService) -> None:
        """Call a service; its response, or why there is none, comes when it comes.

        Raises:
            ProtocolError: nobody provides it, not with that type, or too many calls wait.
        """
        service = resolve_service(request.service, session.limits.name_characters)
        timeout_s = min(request.timeout or session.limits.service_timeout_s, MAX_TIMEOUT_S)
        if self._rosapi.has(service):
            # What needs no other node is answered at once, before the client's next operation.
            local = self._rosapi.answer(service, request.args)
            if isinstance(local, dict):
                _respond(session, request, local)
                return
            call = local
        else:
            type_name = self._types.of_service(service, request.type).name
            call = partial(self._calls.call, service, type_name, request.args, timeout_s)

        async def work() -> None:
            _respond(session, request, await call())

        self._tasks.start(session, request, work)


def _respond(session: Session, request: CallService, values: dict[str, object]) -> None:
    frame = frames.service_response(request.service, request.id, values, result=True)
    session.send(frame, request.fragment_size)
