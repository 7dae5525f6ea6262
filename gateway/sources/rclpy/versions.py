# SPDX-License-Identifier: Apache-2.0
"""Types of one name and two definitions, as REP-2011's hashes tell them apart.

DDS matches topics, also those behind services and actions, by the names of their types alone. So
messages of the other definition arrive, and are read wrongly.
"""

import logging
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Final

from rclpy.node import Node

from gateway.sources.qos import UNKNOWN_NODE, Endpoint, introduced
from gateway.sources.rclpy.profile import endpoint_node, type_hash
from gateway.sources.source import RosError, TopicEvent
from schemas.interface import FEEDBACK_MESSAGE, GET_RESULT, SEND_GOAL

REMEDY: Final = "bring its package, or the folder in types.paths, to the same version everywhere"

_logger = logging.getLogger(__name__)

# the hash of the definition here, of names such as pkg/srv/Name_Request. None if it is unknown
HashOf = Callable[[str], str | None]


def other_versions(
    topic: str, type_name: str, own_hash: str | None, endpoints: Iterable[Endpoint]
) -> list[TopicEvent]:
    """Describe the nodes whose type of this name has another hash, each once."""
    if own_hash is None:
        return []
    nodes = dict.fromkeys(
        endpoint.node
        for endpoint in introduced(endpoints)
        if endpoint.type_name == type_name and endpoint.type_hash not in {None, own_hash}
    )
    problem = f"has another definition of {type_name} than this gateway, so messages are misread"
    return [
        TopicEvent("type_conflict", f"topic {topic}: {node} {problem}", REMEDY, node)
        for node in nodes
    ]


@dataclass(frozen=True, slots=True)
class _Topic:
    """A topic behind a service or an action, and the hash of its type here."""

    name: str  # as DDS has it
    type_name: str
    is_to_server: bool
    own_hash: str | None


class Versions:
    """The definitions that other nodes have of one service or action."""

    def __init__(self, node: Node, subject: str, type_name: str, topics: Sequence[_Topic]) -> None:
        self._node = node
        self._subject = subject
        self._type_name = type_name
        self._topics = [topic for topic in topics if topic.own_hash is not None]
        self._looked_at: frozenset[bytes] | None = frozenset()
        self._conflict: RosError | None = None
        # the nodes that have another definition
        self._servers: set[str] = set()
        self._clients: set[str] = set()

    def conflict(self, servers: frozenset[bytes]) -> RosError | None:
        """Return the refusal of a call if a server has another definition. Log which node's it is.

        *servers* identify them: those in which nothing was found are not looked at again.
        The refusal names no node, as not every client may see them.
        """
        if servers != self._looked_at:
            nodes = self._others(of_servers=True)
            self._conflict = self._refusal() if nodes else None
            # The next call looks for a conflict again. An endpoint of a server that has just ended
            # may be left, or the name of a node may not be known yet.
            self._looked_at = None if nodes else servers
            self._warn(nodes - self._servers, "so it is not called")
            self._servers = nodes
        return self._conflict

    def look_at_clients(self) -> None:
        """Log the nodes that use it and have another definition, each once for as long as it is."""
        nodes = self._others(of_servers=False)
        self._warn(nodes - self._clients, "so its calls are misread")
        self._clients = nodes

    @property
    def _problem(self) -> str:
        return f"has another definition of {self._type_name} than this gateway"

    def _refusal(self) -> RosError:
        problem = f"its server {self._problem}, so it is not called"
        return RosError("type_conflict", f"{self._subject}: {problem}; {REMEDY}")

    def _warn(self, nodes: set[str], consequence: str) -> None:
        for node in sorted(nodes - {UNKNOWN_NODE}):
            problem = f"{node} {self._problem}, {consequence}"
            _logger.warning("%s: %s; %s", self._subject, problem, REMEDY)

    def _others(self, *, of_servers: bool) -> set[str]:
        return {node for topic in self._topics for node in self._others_on(topic, of_servers)}

    def _others_on(self, topic: _Topic, of_servers: bool) -> list[str]:
        """Return the nodes at one end of a topic whose type has its name and another hash."""
        is_reader = topic.is_to_server == of_servers
        find: Any = (
            self._node.get_subscriptions_info_by_topic
            if is_reader
            else self._node.get_publishers_info_by_topic
        )
        return [
            endpoint_node(endpoint)
            for endpoint in find(topic.name, no_mangle=True)
            if endpoint.topic_type == topic.type_name
            and type_hash(endpoint) not in {None, topic.own_hash}
        ]


def of_service(node: Node, subject: str, name: str, type_name: str, hash_of: HashOf) -> Versions:
    """Return the versions of a service of type ``pkg/srv/Name``."""
    return Versions(node, subject, type_name, _topics(name, type_name, hash_of))


def of_action(node: Node, subject: str, name: str, type_name: str, hash_of: HashOf) -> Versions:
    """Return the versions of an action of type ``pkg/action/Name``."""
    feedback = type_name + FEEDBACK_MESSAGE
    topics = [
        *_topics(f"{name}/_action/send_goal", type_name + SEND_GOAL, hash_of),
        *_topics(f"{name}/_action/get_result", type_name + GET_RESULT, hash_of),
        _Topic(f"rt{name}/_action/feedback", _dds_name(feedback), False, hash_of(feedback)),
    ]
    return Versions(node, subject, type_name, topics)


def _topics(name: str, type_name: str, hash_of: HashOf) -> list[_Topic]:
    request, response = f"{type_name}_Request", f"{type_name}_Response"
    return [
        _Topic(f"rq{name}Request", _dds_name(request), True, hash_of(request)),
        _Topic(f"rr{name}Reply", _dds_name(response), False, hash_of(response)),
    ]


def _dds_name(type_name: str) -> str:
    package, kind, name = type_name.split("/")
    return f"{package}::{kind}::dds_::{name}_"
