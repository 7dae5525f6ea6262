# SPDX-License-Identifier: Apache-2.0
"""Services, called and provided, with requests and responses as CDR."""

from collections.abc import Callable, Iterator
from typing import Any

from gateway.sources.rclpy.deferred_destruction import DeferredDestruction
from gateway.sources.rclpy.endpoints import Endpoints, FindConflict, Replier, Reply, Requester
from gateway.sources.rclpy.errors import refusals
from gateway.sources.rclpy.message_classes import MessageClasses
from gateway.sources.rclpy.name_checks import check_service
from gateway.sources.rclpy.service_forms import ServiceForm
from gateway.sources.rclpy.service_versions import Versions, of_service
from gateway.sources.services import ServiceRequest
from gateway.sources.source import RosError, ServerInfo


class RclpyServices:
    """The clients and the servers of one node."""

    def __init__(
        self,
        endpoints: Endpoints,
        deferred: DeferredDestruction,
        on_change: Callable[[], None],
        classes: MessageClasses,
    ) -> None:
        self._endpoints = endpoints
        self._classes = classes
        self._deferred = deferred
        self._on_change = on_change
        self._clients: set[RclpyClient] = set()
        self._provided: dict[str, RclpyService] = {}
        self._versions: dict[str, Versions] = {}  # of what is provided

    def __len__(self) -> int:
        """Count what is open."""
        return len(self._clients) + len(self._provided)

    def type_of(self, service: str) -> str | None:
        """Return the type of a service that is open here, if there is one."""
        if service in self._provided:
            return self._provided[service].type_name
        return next((c.type_name for c in self._clients if c.name == service), None)

    def provided(self) -> Iterator[ServerInfo]:
        """Yield the services that are provided here: DDS may have to find them yet."""
        node = self._endpoints.node.get_fully_qualified_name()
        for name, server in self._provided.items():
            yield ServerInfo(name, (server.type_name,), (node,))

    def client(self, service: str, type_name: str) -> "RclpyClient":
        """Open a client. See `gateway.sources.services.Services.client`."""
        check_service(service)
        client = RclpyClient(
            self._endpoints,
            service,
            self._classes.service(type_name),
            self._clients.discard,
            # a service provided here keeps more, and this loop itself takes its requests
            is_paced=lambda: service not in self._provided,
            find_conflict=self._find_versions(service, type_name).conflict,
        )
        self._clients.add(client)
        return client

    def serve(
        self, service: str, type_name: str, on_request: Callable[[ServiceRequest], None]
    ) -> "RclpyService":
        """Open a server. See `gateway.sources.services.Services.serve`."""
        check_service(service)
        if service in self._provided:
            raise RosError("limit_exceeded", f"service {service} is provided here already")
        self._deferred.destroy_now(f"service {service}")
        form = self._classes.service(type_name)
        server = RclpyService(self._endpoints, service, form, on_request, self._forget)
        self._provided[service] = server
        self._versions[service] = self._find_versions(service, type_name)
        self._on_change()
        return server

    def follow_graph(self) -> None:
        """Let every client follow servers that have come or gone, and report odd callers."""
        for client in list(self._clients):
            client.follow_graph()
        for versions in self._versions.values():
            versions.look_at_clients()

    def close(self) -> None:
        """Close what is still open."""
        for client in list(self._clients):
            client.close()
        for service in list(self._provided.values()):
            service.close()

    def _forget(self, service: "RclpyService") -> None:
        del self._provided[service.name], self._versions[service.name]

        def destroy() -> None:
            service.destroy()
            self._on_change()

        if service.has_answered:
            self._deferred.defer(f"service {service.name}", service.type_name, destroy)
            self._on_change()
        else:
            destroy()

    def _find_versions(self, service: str, type_name: str) -> Versions:
        subject = f"service {service}"
        return of_service(self._endpoints.node, subject, service, type_name, self._classes.hash_of)


class RclpyClient:
    """A client of a service."""

    def __init__(
        self,
        endpoints: Endpoints,
        name: str,
        form: ServiceForm,
        on_close: Callable[["RclpyClient"], None],
        *,
        is_paced: Callable[[], bool],
        find_conflict: FindConflict,
    ) -> None:
        self.name = name
        self.type_name = form.type_name
        self._on_close = on_close
        self._subject = f"service {name}"
        self._form = form
        self._requester = Requester(
            endpoints,
            form.service_class,
            name,
            subject=self._subject,
            is_paced=is_paced,
            find_conflict=find_conflict,
        )

    async def call(self, request: bytes) -> bytes:
        """Wait for a server, send the request, wait for the response. See the port."""
        with refusals(self._subject):
            message = self._form.to_request(request)
        return self._form.to_cdr(await self._requester.send(message))

    def follow_graph(self) -> None:
        """Follow servers that have come or gone."""
        self._requester.follow_graph()

    def close(self) -> None:
        """Destroy it and fail what is under way. Closing twice is harmless."""
        self._on_close(self)
        self._requester.close()


class RclpyRequest:
    """A request that waits for its response."""

    def __init__(self, subject: str, form: ServiceForm, message: Any, reply: Reply) -> None:
        self._subject = subject
        self._form = form
        self._reply: Reply | None = reply
        self.cdr = form.to_cdr(message)

    def answer(self, response: bytes) -> None:
        """Send the response, once. Do nothing if the service is closed."""
        with refusals(self._subject):
            message = self._form.to_response(response)
        reply, self._reply = self._reply, None
        if reply is not None:
            reply(message)


class RclpyService:
    """A service that the gateway provides. Requests are kept by their receiver, not here."""

    def __init__(
        self,
        endpoints: Endpoints,
        name: str,
        form: ServiceForm,
        on_request: Callable[[ServiceRequest], None],
        on_close: Callable[["RclpyService"], None],
    ) -> None:
        self.name = name
        self.type_name = form.type_name
        self._on_request = on_request
        self._on_close = on_close
        self._is_closed = False
        self._subject = f"service {name}"
        self._form = form
        self._replier = Replier(
            endpoints, form.service_class, name, self._arrive, subject=self._subject
        )

    @property
    def has_answered(self) -> bool:
        """True once a response has been sent."""
        return self._replier.has_replied

    def close(self) -> None:
        """Deliver what has arrived and withdraw the service. See the port."""
        if not self._is_closed:
            self._is_closed = True
            try:
                self._replier.drain()
            finally:
                self._on_close(self)

    def destroy(self) -> None:
        """Destroy it, at the latest once its last response has been delivered."""
        self._replier.close()

    def _arrive(self, message: Any, reply: Reply) -> None:
        self._on_request(RclpyRequest(self._subject, self._form, message, reply))
