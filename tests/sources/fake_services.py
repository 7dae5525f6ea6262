# SPDX-License-Identifier: Apache-2.0
"""Services in memory: for the fake's port and for the world outside it alike."""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from gateway.sources.services import ServiceRequest
from gateway.sources.source import RosError

if TYPE_CHECKING:
    from tests.sources.fake import FakeRos


@dataclass(eq=False)
class FakeService:
    """A server of one of the fake's services, outside or the gateway's own."""

    ros: "FakeRos"
    name: str
    type_name: str
    on_request: Callable[[ServiceRequest], None]
    node: str
    is_closing: bool = False

    def close(self) -> None:
        """End it. The gateway's own delivers what has arrived, one outside just vanishes."""
        if self not in self.ros.service_servers or self.is_closing:
            return
        self.is_closing = True
        if self.ros.is_own(self.node):
            for call in [call for client in self.ros.clients for call in client.calls]:
                if call.server is self:
                    self.arrive(call)
        self.ros.service_servers.remove(self)
        self.ros.changed()

    def arrive(self, call: "FakeCall") -> None:
        if self in self.ros.service_servers and not call.has_arrived:
            call.has_arrived = True
            self.on_request(FakeRequest(self, call))


@dataclass(eq=False)
class FakeCall:
    """A request on its way, and the response to come."""

    request: bytes
    response: asyncio.Future[bytes]
    server: FakeService | None = None
    has_arrived: bool = False

    def respond(self, response: bytes) -> None:
        if not self.response.done():  # nobody may be waiting any more
            self.response.set_result(response)


@dataclass(eq=False)
class FakeRequest:
    """A request at its server."""

    server: FakeService
    call: FakeCall
    is_answered: bool = False

    @property
    def cdr(self) -> bytes:
        return self.call.request

    def answer(self, response: bytes) -> None:
        if not self.is_answered and self.server in self.server.ros.service_servers:
            self.is_answered = True
            self.server.ros.loop.call_soon(self.call.respond, response)


@dataclass(eq=False)
class FakeClient:
    """A client of one of the fake's services, outside or the gateway's own."""

    ros: "FakeRos"
    name: str
    type_name: str
    node: str
    calls: list[FakeCall] = field(default_factory=list)

    async def call(self, request: bytes) -> bytes:
        call = FakeCall(request, self.ros.loop.create_future())
        self.calls.append(call)
        self.follow()
        try:
            return await call.response
        finally:
            self.calls.remove(call)

    def close(self) -> None:
        if self in self.ros.clients:
            self.ros.clients.remove(self)
            self.follow()

    def follow(self) -> None:
        """Send what waits for a server. Fail what has lost it, or this client."""
        servers = [s for s in self.ros.service_servers if (s.name, s.type_name) == self._matching]
        for call in self.calls:
            if call.response.done():
                continue
            if self not in self.ros.clients:
                reason = f"the client of service {self.name} is closed"
                call.response.set_exception(RosError("not_found", reason))
            elif call.server is None and servers:
                call.server = servers[0]
                self.ros.loop.call_soon(call.server.arrive, call)
            elif call.server is not None and call.server not in self.ros.service_servers:
                # in a separate turn: an answer that was given before is on its way
                self.ros.loop.call_soon(_fail, call.response, f"service {self.name} has gone")

    @property
    def _matching(self) -> tuple[str, str]:
        return self.name, self.type_name


def _fail(response: asyncio.Future[bytes], reason: str) -> None:
    if not response.done():
        response.set_exception(RosError("not_found", reason))
