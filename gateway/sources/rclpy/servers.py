# SPDX-License-Identifier: Apache-2.0
"""The services, and the actions, that are open through the port."""

from collections.abc import Callable, Iterator
from typing import Generic, TypeVar

from gateway.sources.actions import GoalRequest
from gateway.sources.graph import ServerInfo
from gateway.sources.name_checks import check_action, check_service
from gateway.sources.rclpy.action_client import RclpyActionClient
from gateway.sources.rclpy.action_server import RclpyActionServer
from gateway.sources.rclpy.deferred_destruction import DeferredDestruction
from gateway.sources.rclpy.message_classes import MessageClasses
from gateway.sources.rclpy.ready_events import Endpoints
from gateway.sources.rclpy.samples import Samples
from gateway.sources.rclpy.service_entities import RclpyClient, RclpyService
from gateway.sources.rclpy.versions import Versions, of_action, of_service
from gateway.sources.services import ServiceRequest
from gateway.sources.source import RosError

# Checks that one more may be opened: its subject, its type, and the type that is open here.
CheckNew = Callable[[str, str, str | None], None]


C = TypeVar("C", RclpyClient, RclpyActionClient)
S = TypeVar("S", RclpyService, RclpyActionServer)


class _Open(Generic[C, S]):
    """The clients and the servers of one node, of services or of actions."""

    _kind: str

    def __init__(
        self,
        endpoints: Endpoints,
        deferred: DeferredDestruction,
        on_change: Callable[[], None],
        classes: MessageClasses,
        check_new: CheckNew,
    ) -> None:
        self._endpoints = endpoints
        self._deferred = deferred
        self._on_change = on_change
        self._classes = classes
        self._check_new = check_new
        self._clients: set[C] = set()
        self._provided: dict[str, S] = {}
        self._versions: dict[str, Versions] = {}  # of what is provided

    def __len__(self) -> int:
        """Count what is open."""
        return len(self._clients) + len(self._provided)

    def provided(self) -> Iterator[ServerInfo]:
        """Yield what is provided here: DDS may have to find it yet."""
        node = self._endpoints.node.get_fully_qualified_name()
        for name, server in self._provided.items():
            yield ServerInfo(name, (server.type_name,), (node,))

    def follow_graph(self) -> None:
        """Let every client follow servers that have come or gone, and report odd clients."""
        for client in list(self._clients):
            client.follow_graph()
        for versions in self._versions.values():
            versions.look_at_clients()

    def _check(self, name: str, type_name: str) -> None:
        """Check that a client or a server may be opened."""
        if name in self._provided:
            known: str | None = self._provided[name].type_name
        else:
            known = next((each.type_name for each in self._clients if each.name == name), None)
        self._check_new(f"{self._kind} {name}", type_name, known)

    def _check_server(self, name: str) -> None:
        """Check that a server may be opened besides."""
        if name in self._provided:
            raise RosError("limit_exceeded", f"{self._kind} {name} is provided here already")
        self._deferred.destroy_now(f"{self._kind} {name}")

    def _add(self, server: S, versions: Versions) -> S:
        self._provided[server.name] = server
        self._versions[server.name] = versions
        self._on_change()
        return server

    def _forget(self, server: S) -> None:
        del self._provided[server.name], self._versions[server.name]

        def destroy() -> None:
            server.destroy()
            self._on_change()

        if server.has_answered:
            self._deferred.defer(f"{self._kind} {server.name}", server.type_name, destroy)
            self._on_change()
        else:
            destroy()


class RclpyServices(_Open[RclpyClient, RclpyService]):
    """The services, as `gateway.sources.services.Services` describes them."""

    _kind = "service"

    def client(self, service: str, type_name: str) -> RclpyClient:
        """Create a client of a service by its fully resolved name. See the port."""
        self._check(service, type_name)
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
    ) -> RclpyService:
        """Provide a service by its fully resolved name. See the port."""
        self._check(service, type_name)
        check_service(service)
        self._check_server(service)
        form = self._classes.service(type_name)
        server = RclpyService(self._endpoints, service, form, on_request, self._forget)
        return self._add(server, self._find_versions(service, type_name))

    def close(self) -> None:
        """Close what is still open."""
        for client in list(self._clients):
            client.close()
        for service in list(self._provided.values()):
            service.close()

    def _find_versions(self, service: str, type_name: str) -> Versions:
        subject = f"service {service}"
        return of_service(self._endpoints.node, subject, service, type_name, self._classes.hash_of)


class RclpyActions(_Open[RclpyActionClient, RclpyActionServer]):
    """The actions, as `gateway.sources.actions.Actions` describes them.

    *samples* takes the feedback.
    """

    _kind = "action"

    def __init__(
        self,
        endpoints: Endpoints,
        deferred: DeferredDestruction,
        on_change: Callable[[], None],
        classes: MessageClasses,
        check_new: CheckNew,
        *,
        samples: Samples,
        now_ns: Callable[[], int],
    ) -> None:
        super().__init__(endpoints, deferred, on_change, classes, check_new)
        self._samples = samples
        self._now_ns = now_ns

    def action_client(self, action: str, type_name: str) -> RclpyActionClient:
        """Create a client of an action by its fully resolved name. See the port."""
        self._check(action, type_name)
        check_action(action)
        client = RclpyActionClient(
            self._endpoints,
            self._samples,
            action,
            self._classes.action(type_name),
            self._clients.discard,
            # an action provided here keeps more, and this loop itself takes its requests
            is_paced=lambda: action not in self._provided,
            find_conflict=self._find_versions(action, type_name).conflict,
        )
        self._clients.add(client)
        return client

    def serve_action(
        self,
        action: str,
        type_name: str,
        on_goal: Callable[[GoalRequest], None],
        on_cancel: Callable[[GoalRequest], None],
    ) -> RclpyActionServer:
        """Provide an action by its fully resolved name. See the port."""
        self._check(action, type_name)
        check_action(action)
        self._check_server(action)
        server = RclpyActionServer(
            self._endpoints,
            self._now_ns,
            action,
            self._classes.action(type_name),
            on_goal,
            on_cancel,
            self._forget,
        )
        return self._add(server, self._find_versions(action, type_name))

    def close(self) -> None:
        """Close what is still open without waiting for answers."""
        for client in list(self._clients):
            client.withdraw()
            self._deferred.defer(f"action {client.name}", client.type_name, client.destroy)
        for server in list(self._provided.values()):
            server.close()

    def _find_versions(self, action: str, type_name: str) -> Versions:
        subject = f"action {action}"
        return of_action(self._endpoints.node, subject, action, type_name, self._classes.hash_of)
