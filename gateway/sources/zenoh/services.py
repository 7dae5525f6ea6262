# SPDX-License-Identifier: Apache-2.0
"""Services over Zenoh, called and provided, with requests and responses as CDR."""

from collections.abc import Callable

from gateway.sources.name_checks import check_service
from gateway.sources.services import ServiceRequest
from gateway.sources.source import RosError
from gateway.sources.zenoh.replier import Reply, ZenohReplier
from gateway.sources.zenoh.requester import ZenohEndpoints, ZenohRequester
from gateway.sources.zenoh.service_forms import ServiceWire, check

# Checks that one more may be opened: its subject, its type, and the type that is open here.
CheckNew = Callable[[str, str, str | None], None]


class ZenohServices:
    """Implements `gateway.sources.services.Services`. *wire_of* finds the form of a type."""

    def __init__(
        self,
        endpoints: ZenohEndpoints,
        wire_of: Callable[[str], ServiceWire],
        check_new: CheckNew,
        on_change: Callable[[], None],
    ) -> None:
        self.endpoints = endpoints
        self._wire_of, self._check_new, self._on_change = wire_of, check_new, on_change
        self._clients: dict[ZenohClient, None] = {}
        self._provided: dict[str, ZenohService] = {}

    def __len__(self) -> int:
        """Count what is open."""
        return len(self._clients) + len(self._provided)

    def client(self, service: str, type_name: str) -> "ZenohClient":
        """Create a client of a service by its fully resolved name. See the port."""
        wire = self._checked(service, type_name)
        client = ZenohClient(self, service, wire, lambda: service not in self._provided)
        self._clients[client] = None
        return client

    def serve(
        self, service: str, type_name: str, on_request: Callable[[ServiceRequest], None]
    ) -> "ZenohService":
        """Provide a service by its fully resolved name. See the port."""
        wire = self._checked(service, type_name)
        if service in self._provided:
            raise RosError("limit_exceeded", f"service {service} is provided here already")
        server = self._provided[service] = ZenohService(self, service, wire, on_request)
        self._on_change()
        return server

    def follow_graph(self) -> None:
        """Let every client follow servers that have come or gone."""
        for client in list(self._clients):
            client.requester.follow_graph()

    def close(self) -> None:
        """Close what is still open."""
        for client in list(self._clients):
            client.close()
        for server in list(self._provided.values()):
            server.close()

    def forget_client(self, closed: "ZenohClient") -> None:
        """Note that it is closed."""
        self._clients.pop(closed, None)

    def forget_service(self, closed: "ZenohService") -> None:
        """Note that it is closed."""
        if self._provided.get(closed.name) is closed:
            del self._provided[closed.name]
            self._on_change()

    def _checked(self, service: str, type_name: str) -> ServiceWire:
        opened = [(each.name, each.wire.type_name) for each in self._clients]
        opened += [(each.name, each.wire.type_name) for each in self._provided.values()]
        self._check_new(f"service {service}", type_name, dict(opened).get(service))
        check_service(service)
        return self._wire_of(type_name)


class ZenohClient:
    """Implements `gateway.sources.services.ServiceClient`."""

    def __init__(
        self, services: ZenohServices, name: str, wire: ServiceWire, is_paced: Callable[[], bool]
    ) -> None:
        self.name, self.wire, self._services = name, wire, services
        self._subject = f"service {name}"
        self.requester = ZenohRequester(
            services.endpoints, wire, name, subject=self._subject, is_paced=is_paced
        )

    async def call(self, request: bytes) -> bytes:
        """Wait for a server, send the request, wait for the response. See the port."""
        check(self._subject, self.wire.read_request, request)
        response: bytes = await self.requester.send(request)
        return response

    def close(self) -> None:
        """Withdraw it and fail what is under way. Closing twice is harmless."""
        self._services.forget_client(self)
        self.requester.close()


class ZenohRequest:
    """Implements `gateway.sources.services.ServiceRequest`."""

    def __init__(self, service: "ZenohService", cdr: bytes, reply: Reply) -> None:
        self._service, self.cdr = service, cdr
        self._reply: Reply | None = reply

    def answer(self, response: bytes) -> None:
        """Send the response, once. Do nothing if the service is closed."""
        check(f"service {self._service.name}", self._service.wire.read_response, response)
        reply, self._reply = self._reply, None
        if reply is not None:
            reply(response)


class ZenohService:
    """Implements `gateway.sources.services.Service`."""

    def __init__(
        self,
        services: ZenohServices,
        name: str,
        wire: ServiceWire,
        on_request: Callable[[ServiceRequest], None],
    ) -> None:
        self.name, self.wire, self._services = name, wire, services
        self._replier = ZenohReplier(
            services.endpoints,
            wire,
            name,
            lambda cdr, reply: on_request(ZenohRequest(self, cdr, reply)),
            subject=f"service {name}",
        )

    def close(self) -> None:
        """Deliver what has arrived and withdraw the service. See the port."""
        try:
            self._replier.close()
        finally:
            self._services.forget_service(self)
