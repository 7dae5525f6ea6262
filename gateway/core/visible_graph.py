# SPDX-License-Identifier: Apache-2.0
"""The ROS graph as a role sees it: what it may do nothing with does not exist."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace

from gateway.sources.graph import Graph, ServerInfo, TopicInfo
from gateway.sources.source import RosGraph

Sees = Callable[[str], bool]


def visible(graph: Graph, sees: Sees) -> Graph:
    """Return a graph without the names that are hidden. Nodes are names like all others."""
    return Graph(
        topics=tuple(_topic(topic, sees) for topic in graph.topics if sees(topic.name)),
        nodes=_names(graph.nodes, sees),
        services=tuple(_server(each, sees) for each in graph.services if sees(each.name)),
        actions=tuple(_server(each, sees) for each in graph.actions if sees(each.name)),
    )


class VisibleGraph:
    """The part of ROS that only looks, without what is hidden."""

    def __init__(self, ros: RosGraph, sees: Sees) -> None:
        self._ros = ros
        self._sees = sees

    @property
    def distro(self) -> str:
        """The ROS distribution."""
        return self._ros.distro

    @property
    def network(self) -> Mapping[str, str | int]:
        """The network in which nodes are found."""
        return self._ros.network

    def now_ns(self) -> int:
        """ROS time in nanoseconds."""
        return self._ros.now_ns()

    def service_types(self, service: str) -> tuple[str, ...]:
        """Return the types of a service. A hidden one has none, as one that does not exist."""
        return self._ros.service_types(service) if self._sees(service) else ()

    def graph(self) -> Graph:
        """Return the graph that is known now, without what is hidden."""
        return visible(self._ros.graph(), self._sees)


def _topic(topic: TopicInfo, sees: Sees) -> TopicInfo:
    publishers, subscribers = _names(topic.publishers, sees), _names(topic.subscribers, sees)
    return replace(topic, publishers=publishers, subscribers=subscribers)


def _server(server: ServerInfo, sees: Sees) -> ServerInfo:
    return replace(server, nodes=_names(server.nodes, sees))


def _names(names: Iterable[str], sees: Sees) -> tuple[str, ...]:
    return tuple(name for name in names if sees(name))
