# SPDX-License-Identifier: Apache-2.0
"""The ROS graph as frames for clients: a snapshot, then changes."""

from collections.abc import Iterable, Mapping
from typing import Any, TypeVar

from gateway.sources.graph import Graph, ServerInfo, TopicInfo


def picture(graph: Graph, rates_hz: Mapping[str, float]) -> dict[str, Any]:
    """Return the members of a `graph` answer. Rates are known for received topics only."""
    return {
        "topics": [_topic(topic, rates_hz) for topic in graph.topics],
        "services": [_provided(service) for service in graph.services],
        "actions": [_provided(action) for action in graph.actions],
        "nodes": list(graph.nodes),
    }


def changes(before: Graph, after: Graph) -> dict[str, Any]:
    """Return the members of a later `graph` frame, empty if nothing changed.

    ``topics``, ``services`` and ``actions`` hold complete entries, those new or different.
    ``gone_topics`` and the like, ``nodes`` and ``gone_nodes`` hold names.
    """
    new_topics, gone_topics = _difference(before.topics, after.topics)
    new_services, gone_services = _difference(before.services, after.services)
    new_actions, gone_actions = _difference(before.actions, after.actions)
    members: dict[str, Any] = {
        "topics": [_topic(topic, {}) for topic in new_topics],
        "gone_topics": gone_topics,
        "services": [_provided(service) for service in new_services],
        "gone_services": gone_services,
        "actions": [_provided(action) for action in new_actions],
        "gone_actions": gone_actions,
        "nodes": [node for node in after.nodes if node not in set(before.nodes)],
        "gone_nodes": [node for node in before.nodes if node not in set(after.nodes)],
    }
    return {name: value for name, value in members.items() if value}


T = TypeVar("T", TopicInfo, ServerInfo)


def _difference(before: Iterable[T], after: Iterable[T]) -> tuple[list[T], list[str]]:
    """Return new and different entries, and the names of those that are gone."""
    known = {each.name: each for each in before}
    now = {each.name: each for each in after}
    new = [each for name, each in now.items() if known.get(name) != each]
    return new, [name for name in known if name not in now]


def _provided(provided: ServerInfo) -> dict[str, Any]:
    return {
        "name": provided.name,
        "types": list(provided.types),
        "nodes": list(provided.nodes),
    }


def _topic(topic: TopicInfo, rates_hz: Mapping[str, float]) -> dict[str, Any]:
    members: dict[str, Any] = {
        "name": topic.name,
        "types": list(topic.types),
        "publishers": list(topic.publishers),
        "subscribers": list(topic.subscribers),
    }
    if topic.name in rates_hz:
        members["rate_hz"] = round(rates_hz[topic.name], 2)
    return members
