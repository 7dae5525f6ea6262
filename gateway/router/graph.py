# SPDX-License-Identifier: Apache-2.0
"""The ROS graph as clients see it: one picture, then what changed."""

from collections.abc import Mapping
from typing import Any

from gateway.ports import Graph, Topic


def picture(graph: Graph, rates_hz: Mapping[str, float]) -> dict[str, Any]:
    """Return the members of a `graph` answer; rates are known for received topics only."""
    return {
        "topics": [_topic(topic, rates_hz) for topic in graph.topics],
        "nodes": list(graph.nodes),
    }


def changes(before: Graph, after: Graph) -> dict[str, Any]:
    """Return the members of a later `graph` frame, empty where nothing changed.

    ``topics`` holds what is new or different, complete; ``gone_topics``, ``nodes`` and
    ``gone_nodes`` hold names.
    """
    known = {topic.name: topic for topic in before.topics}
    now = {topic.name: topic for topic in after.topics}
    members: dict[str, Any] = {
        "topics": [_topic(topic, {}) for name, topic in now.items() if known.get(name) != topic],
        "gone_topics": [name for name in known if name not in now],
        "nodes": [node for node in after.nodes if node not in set(before.nodes)],
        "gone_nodes": [node for node in before.nodes if node not in set(after.nodes)],
    }
    return {name: value for name, value in members.items() if value}


def _topic(topic: Topic, rates_hz: Mapping[str, float]) -> dict[str, Any]:
    members: dict[str, Any] = {
        "name": topic.name,
        "types": list(topic.types),
        "publishers": list(topic.publishers),
        "subscribers": list(topic.subscribers),
    }
    if topic.name in rates_hz:
        members["rate_hz"] = round(rates_hz[topic.name], 2)
    return members
