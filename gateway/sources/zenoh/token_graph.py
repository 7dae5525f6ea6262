# SPDX-License-Identifier: Apache-2.0
"""The ROS graph as the tokens of a router describe it."""

import logging
from collections.abc import Iterable, Mapping, Sequence
from typing import Final, Literal

from gateway.sources.graph import Graph, ServerInfo, TopicInfo
from gateway.sources.node_definitions import TypeHolder
from gateway.sources.qos import Endpoint, is_latched
from gateway.sources.zenoh.keys import NO_TYPE_HASH, DataKey, WireError
from gateway.sources.zenoh.tokens import EndpointKind, EndpointToken, NodeToken, parse_token

_BEHIND_ACTION: Final = "/_action/"
_SEND_GOAL: Final = f"{_BEHIND_ACTION}send_goal"
_SEND_GOAL_TYPE: Final = "_SendGoal"
# Of tokens that cannot be read, the first are in the log.
MAX_NAMED_FAULTS: Final = 8
# Of one topic or service, of one kind. Each subscription looks at all publishers of its topic.
MAX_OF_NAME: Final = 1024

_logger = logging.getLogger(__name__)

Named = dict[str, dict[str, EndpointToken]]
"""Endpoints of one kind: by topic or service, then by token."""


class TokenGraph:
    """The nodes and endpoints that exist now, the gateway's own included."""

    def __init__(self, own_session: str) -> None:
        self._own = own_session
        self._nodes: dict[str, NodeToken] = {}
        self._of_kind: dict[EndpointKind, Named] = {"MP": {}, "MS": {}, "SS": {}, "SC": {}}
        self._places: dict[str, EndpointToken] = {}
        self._beyond: dict[tuple[EndpointKind, str], dict[str, EndpointToken]] = {}
        self._with_hash = self._without_hash = 0  # endpoints of the robot
        self._publishers: dict[bytes, EndpointToken] = {}  # by gid
        self._whole: Graph | None = None
        self._topics: dict[str, tuple[str, ...]] | None = None
        self.unread = 0  # tokens that are not those of rmw_zenoh

    def apply(self, changes: Mapping[str, bool]) -> None:
        """Add the tokens that are there, and remove the others."""
        self._whole = self._topics = None
        for text, is_there in changes.items():
            if is_there:
                self.add(text)
            else:
                self.remove(text)

    def add(self, text: str) -> None:
        """Add a token. Twice is harmless."""
        if text in self._places or text in self._nodes:
            return
        try:
            token = parse_token(text)
        except WireError as error:
            self.unread += 1
            if self.unread <= MAX_NAMED_FAULTS:
                _logger.warning("a participant has a token that is left out: %s", error)
            return
        self._whole = self._topics = None
        if isinstance(token, NodeToken):
            self._nodes[text] = token
            return
        self._places[text] = token
        self._count(token, 1)
        named = self._of_kind[token.kind].setdefault(token.key.name, {})
        if len(named) >= MAX_OF_NAME:
            named = self._beyond.setdefault((token.kind, token.key.name), {})
        named[text] = token
        if token.kind == "MP":
            self._publishers[token.gid] = token

    def remove(self, text: str) -> None:
        """Remove a token. An unknown one is ignored."""
        self._whole = self._topics = None
        self._nodes.pop(text, None)
        token = self._places.pop(text, None)
        if token is None:
            return
        self._count(token, -1)
        if token.kind == "MP":
            self._publishers.pop(token.gid, None)
        kind, name = token.kind, token.key.name
        shown, beyond = self._of_kind[kind][name], self._beyond.get((kind, name), {})
        if beyond:
            left_out = text if text in beyond else next(iter(beyond))
            shown[left_out] = beyond.pop(left_out)
            if not beyond:
                del self._beyond[kind, name]
        del shown[text]
        if not shown:
            del self._of_kind[kind][name]

    def has_node(self, text: str) -> bool:
        """Return whether there is a node with this token. Any thread may ask."""
        return text in self._nodes

    def has_publisher(self, gid: bytes) -> bool:
        """Return whether a publisher with this id has a token."""
        return gid in self._publishers

    @property
    def is_humble(self) -> bool:
        """True if no node of the robot has hashes of types, as on Humble.

        Hidden nodes, such as the guard and the command line of ROS, are not those of the robot.
        """
        return self._without_hash > 0 and not self._with_hash

    @property
    def has_too_many(self) -> bool:
        """True while endpoints of a topic or a service are left out."""
        return bool(self._beyond)

    def endpoints(self, kind: EndpointKind, name: str) -> Sequence[EndpointToken]:
        """Return the endpoints of one topic or service."""
        return tuple(self._of_kind[kind].get(name, {}).values())

    def offers(self, topic: str) -> list[Endpoint]:
        """Return what the publishers of a topic offer, of any type."""
        return [to_endpoint(each) for each in self.endpoints("MP", topic)]

    def has_buffers(self, topic: str, type_name: str) -> bool:
        """Return whether a publisher of a topic puts octets where accelerators can read them."""
        publishers = self.endpoints("MP", topic)
        return any(each.has_buffers and each.key.type_name == type_name for each in publishers)

    def requests(self, topic: str) -> list[Endpoint]:
        """Return what the subscriptions to a topic ask for, of any type."""
        return [to_endpoint(each) for each in self.endpoints("MS", topic)]

    def readers(self, topic: str) -> frozenset[str]:
        """Return the ids of the subscriptions to a topic, except the gateway's own."""
        return frozenset(each.gid.hex() for each in self._others(self.endpoints("MS", topic)))

    def published_by_others(self, topic: str) -> frozenset[DataKey]:
        """Return the keys of the publishers of a topic, except the gateway's own."""
        return frozenset(each.key for each in self._others(self.endpoints("MP", topic)))

    def holders(self, topic: str, type_name: str) -> tuple[TypeHolder, ...]:
        """Return the nodes that have a type, publishers first, without those that show no hash."""
        endpoints = (*self.endpoints("MP", topic), *self.endpoints("MS", topic))
        return tuple(
            dict.fromkeys(
                TypeHolder(each.of.node, each.key.type_hash)
                for each in self._others(endpoints)
                if each.key.type_name == type_name and each.key.type_hash != NO_TYPE_HASH
            )
        )

    def hash_for(
        self, kind: EndpointKind, topic: str, type_name: str, own: str, now: str | None = None
    ) -> str:
        """Return the hash that an endpoint of this gateway needs, to meet those of this kind.

        *own* is that of the definition here. The one that is in use *now* stays while it meets one.
        """
        shown = {
            each.key.type_hash
            for each in self._others(self.endpoints(kind, topic))
            if each.key.type_name == type_name
        }
        for each in (now, own, NO_TYPE_HASH):
            if each in shown:
                return each
        return now or (NO_TYPE_HASH if self.is_humble else own)

    def has_without_hash(self, type_name: str) -> bool:
        """Return whether a node has a type and shows no hash of it."""
        return any(
            (each.key.type_name, each.key.type_hash) == (type_name, NO_TYPE_HASH)
            for each in self._others(self._places.values())
        )

    def topics(self) -> Mapping[str, tuple[str, ...]]:
        """Return the types of all topics."""
        if self._topics is None:
            publishers, subscribers = self._of_kind["MP"], self._of_kind["MS"]
            self._topics = {
                name: _types({**publishers.get(name, {}), **subscribers.get(name, {})}.values())
                for name in {**publishers, **subscribers}
            }
        return self._topics

    def topic_types(self, topic: str) -> tuple[str, ...]:
        """Return the types of one topic. See `gateway.sources.source.Source.topic_types`."""
        publishers = self.endpoints("MP", topic)
        if publishers:
            return _types(publishers)
        subscribers = self.endpoints("MS", topic)
        return _types(self._others(subscribers) or subscribers)

    def service_types(self, service: str) -> tuple[str, ...]:
        """Return the types of one service, also of one behind an action."""
        return _types(self.endpoints("SS", service))

    def action_types(self, action: str) -> tuple[str, ...]:
        """Return the types of one action."""
        found = self.service_types(action + _SEND_GOAL)
        return tuple(each.removesuffix(_SEND_GOAL_TYPE) for each in found)

    def whole(self) -> Graph:
        """Return all of it."""
        if self._whole is None:
            self._whole = self._read()
        return self._whole

    def nodes(self) -> list[str]:
        """Return the full names of all nodes. A name that several have is there as often."""
        return [each.node for each in self._nodes.values()]

    def _read(self) -> Graph:
        topics = tuple(
            TopicInfo(
                name,
                types,
                self._nodes_with("MP", name),
                self._nodes_with("MS", name),
                is_latched(self.offers(name)),
            )
            for name, types in sorted(self.topics().items())
            if _BEHIND_ACTION not in name
        )
        servers = self._of_kind["SS"]
        services, actions = [], []
        for name in sorted(servers):
            nodes = self._nodes_with("SS", name)
            if _BEHIND_ACTION not in name:
                services.append(ServerInfo(name, self.service_types(name), nodes))
            elif name.endswith(_SEND_GOAL):
                action = name.removesuffix(_SEND_GOAL)
                actions.append(ServerInfo(action, self.action_types(action), nodes))
        shown = tuple(sorted(each for each in self.nodes() if not _is_hidden(each)))
        return Graph(topics, shown, tuple(services), tuple(actions))

    def _nodes_with(self, kind: Literal["MP", "MS", "SS"], name: str) -> tuple[str, ...]:
        return tuple(sorted(each.of.node for each in self.endpoints(kind, name)))

    def _count(self, token: EndpointToken, change: int) -> None:
        if token.of.session == self._own or _is_hidden(token.of.node):
            return
        if token.key.type_hash == NO_TYPE_HASH:
            self._without_hash += change
        else:
            self._with_hash += change

    def _others(self, endpoints: Iterable[EndpointToken]) -> list[EndpointToken]:
        return [each for each in endpoints if each.of.session != self._own]


def to_endpoint(token: EndpointToken) -> Endpoint:
    """Return what a token says of an endpoint, for `gateway.sources.qos`."""
    qos, type_hash = token.qos, token.key.type_hash
    return Endpoint(
        token.of.node,
        token.key.type_name,
        qos.reliability,
        qos.durability,
        qos.depth,
        qos.deadline_ns,
        qos.lifespan_ns,
        qos.lease_ns,
        qos.is_manual,
        None if type_hash == NO_TYPE_HASH else type_hash,
    )


def _types(endpoints: Iterable[EndpointToken]) -> tuple[str, ...]:
    return tuple(sorted({each.key.type_name for each in endpoints}))


def _is_hidden(node: str) -> bool:
    return node.rpartition("/")[2].startswith("_")
