# SPDX-License-Identifier: Apache-2.0
"""The actions that are open through the port."""

from collections.abc import Callable, Iterator

from gateway.sources.actions import GoalRequest
from gateway.sources.rclpy.action_client import RclpyActionClient
from gateway.sources.rclpy.action_server import RclpyActionServer
from gateway.sources.rclpy.deferred_destruction import DeferredDestruction
from gateway.sources.rclpy.endpoints import Endpoints
from gateway.sources.rclpy.message_classes import MessageClasses
from gateway.sources.rclpy.name_checks import check_action
from gateway.sources.rclpy.samples import Samples
from gateway.sources.rclpy.service_versions import Versions, of_action
from gateway.sources.source import RosError, ServerInfo


class RclpyActions:
    """The clients and the servers of one node. *samples* takes the feedback."""

    def __init__(
        self,
        endpoints: Endpoints,
        samples: Samples,
        deferred: DeferredDestruction,
        now_ns: Callable[[], int],
        on_change: Callable[[], None],
        classes: MessageClasses,
    ) -> None:
        self._endpoints = endpoints
        self._on_change = on_change
        self._classes = classes
        self._samples = samples
        self._deferred = deferred
        self._now_ns = now_ns
        self._clients: set[RclpyActionClient] = set()
        self._provided: dict[str, RclpyActionServer] = {}
        self._versions: dict[str, Versions] = {}  # of what is provided

    def __len__(self) -> int:
        """Count what is open."""
        return len(self._clients) + len(self._provided)

    def type_of(self, action: str) -> str | None:
        """Return the type of an action that is open here, if there is one."""
        if action in self._provided:
            return self._provided[action].type_name
        return next((c.type_name for c in self._clients if c.name == action), None)

    def provided(self) -> Iterator[ServerInfo]:
        """Yield the actions that are provided here: DDS may have to find them yet."""
        node = self._endpoints.node.get_fully_qualified_name()
        for name, server in self._provided.items():
            yield ServerInfo(name, (server.type_name,), (node,))

    def client(self, action: str, type_name: str) -> RclpyActionClient:
        """Open a client. See `gateway.sources.actions.Actions.action_client`."""
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

    def serve(
        self,
        action: str,
        type_name: str,
        on_goal: Callable[[GoalRequest], None],
        on_cancel: Callable[[GoalRequest], None],
    ) -> RclpyActionServer:
        """Open a server. See `gateway.sources.actions.Actions.serve_action`."""
        check_action(action)
        if action in self._provided:
            raise RosError("limit_exceeded", f"action {action} is provided here already")
        self._deferred.destroy_now(f"action {action}")
        server = RclpyActionServer(
            self._endpoints,
            self._now_ns,
            action,
            self._classes.action(type_name),
            on_goal,
            on_cancel,
            self._forget,
        )
        self._provided[action] = server
        self._versions[action] = self._find_versions(action, type_name)
        self._on_change()
        return server

    def follow_graph(self) -> None:
        """Let every client follow servers that have come or gone, and report odd clients."""
        for client in list(self._clients):
            client.follow_graph()
        for versions in self._versions.values():
            versions.look_at_clients()

    def close(self) -> None:
        """Close what is still open without waiting for answers."""
        for client in list(self._clients):
            client.withdraw()
            self._deferred.defer(f"action {client.name}", client.type_name, client.destroy)
        for server in list(self._provided.values()):
            server.close()

    def _forget(self, server: RclpyActionServer) -> None:
        del self._provided[server.name], self._versions[server.name]

        def destroy() -> None:
            server.destroy()
            self._on_change()

        if server.has_answered:
            self._deferred.defer(f"action {server.name}", server.type_name, destroy)
            self._on_change()
        else:
            destroy()

    def _find_versions(self, action: str, type_name: str) -> Versions:
        subject = f"action {action}"
        return of_action(self._endpoints.node, subject, action, type_name, self._classes.hash_of)
