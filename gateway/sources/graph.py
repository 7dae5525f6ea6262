# SPDX-License-Identifier: Apache-2.0
"""The graph of a robot: topics, services, actions, and the nodes that have them."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class TopicInfo:
    """A topic of the graph: its types (more than one is a conflict) and its endpoints."""

    name: str
    types: tuple[str, ...]  # pkg/msg/Name
    publishers: tuple[str, ...]  # full node names, one entry per endpoint, sorted
    subscribers: tuple[str, ...]
    is_latched: bool = False  # its publishers keep messages for late subscribers


@dataclass(frozen=True, slots=True)
class ServerInfo:
    """A service or an action of the graph: its types, and the nodes that provide it."""

    name: str
    types: tuple[str, ...]  # pkg/srv/Name or pkg/action/Name
    nodes: tuple[str, ...]  # full names, sorted, without those that several nodes share


@dataclass(frozen=True, slots=True)
class Graph:
    """A snapshot of the ROS graph, sorted by name."""

    topics: tuple[TopicInfo, ...]
    nodes: tuple[str, ...]  # full names
    services: tuple[ServerInfo, ...] = ()  # without those behind actions
    actions: tuple[ServerInfo, ...] = ()
