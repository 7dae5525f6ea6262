# SPDX-License-Identifier: Apache-2.0
"""The graph as the port answers with it: kept until it changes, with what is open here in it."""

from collections.abc import Callable, Iterable
from dataclasses import replace

from gateway.sources.graph import Graph, ServerInfo
from gateway.sources.options import RosOptions
from gateway.sources.rclpy.deferred_destruction import DeferredDestruction
from gateway.sources.rclpy.graph import read_actions, read_all_services, read_graph, read_types
from gateway.sources.rclpy.nodes import Nodes

ProvidedHere = Callable[[], Iterable[ServerInfo]]


class KnownGraph:
    """Reads the graph. Entities that are opened or closed here change it without a report."""

    def __init__(
        self,
        nodes: Nodes,
        options: RosOptions,
        deferred: DeferredDestruction,
        services_here: ProvidedHere,
        actions_here: ProvidedHere,
    ) -> None:
        self._nodes = nodes
        self._options = options
        self._deferred = deferred
        self._services_here = services_here
        self._actions_here = actions_here
        self._graph: Graph | None = None
        self._types: dict[str, tuple[str, ...]] = {}
        self._service_types: dict[str, tuple[str, ...]] | None = None
        self._action_types: dict[str, tuple[str, ...]] | None = None

    def topic_types(self, topic: str) -> tuple[str, ...]:
        """Return the types of a topic."""
        known = self._types.get(topic)
        if known is None:
            nodes, guard = self._nodes, self._options.guard_node
            publishing = nodes.publishing_on(topic)
            known = read_types(nodes.debug, topic, nodes.own, guard, publishing)
            if known:  # clients may name any number of topics that do not exist
                self._types[topic] = known
        return known

    def service_types(self, service: str) -> tuple[str, ...]:
        """Return the types of a service."""
        # A change is reported a little after it happens: a name that is not known may be new.
        if self._service_types is None or service not in self._service_types:
            found = self._services(read_all_services(self._nodes.debug))
            self._service_types = {each.name: each.types for each in found}
        return self._service_types.get(service, ())

    def action_types(self, action: str) -> tuple[str, ...]:
        """Return the types of an action. See `service_types`."""
        if self._action_types is None or action not in self._action_types:
            found = self._actions(read_actions(self._nodes.debug))
            self._action_types = {each.name: each.types for each in found}
        return self._action_types.get(action, ())

    def whole(self) -> Graph:
        """Return all of it."""
        if self._graph is None:
            graph = read_graph(self._nodes.debug, self._options.hidden_nodes)
            services, actions = self._services(graph.services), self._actions(graph.actions)
            self._graph = replace(graph, services=services, actions=actions)
        return self._graph

    def topics_changed(self) -> None:
        """Forget what is kept of topics."""
        self._graph = None
        self._types.clear()

    def services_changed(self) -> None:
        """Forget what is kept of services."""
        self._graph = None
        self._service_types = None

    def actions_changed(self) -> None:
        """Forget what is kept of actions, and of their services."""
        self.services_changed()
        self._action_types = None

    def _services(self, found: Iterable[ServerInfo]) -> tuple[ServerInfo, ...]:
        return self._as_here("service", found, self._services_here())

    def _actions(self, found: Iterable[ServerInfo]) -> tuple[ServerInfo, ...]:
        return self._as_here("action", found, self._actions_here())

    def _as_here(
        self, kind: str, found: Iterable[ServerInfo], provided: Iterable[ServerInfo]
    ) -> tuple[ServerInfo, ...]:
        """Add what DDS has to find yet. Leave out what awaits its deferred destruction."""
        known = {each.name: each for each in (*provided, *found)}
        return tuple(
            known[name]
            for name in sorted(known)
            if not (set(known[name].nodes) <= self._nodes.own)
            or not self._deferred.is_deferred(f"{kind} {name}")
        )
