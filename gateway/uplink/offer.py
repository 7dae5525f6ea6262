# SPDX-License-Identifier: Apache-2.0
"""The part of the robot's graph that an uplink offers, and the names that it has there."""

import asyncio
from collections.abc import Callable, Collection, Iterable, Iterator
from dataclasses import dataclass, field, replace
from typing import Final, NamedTuple

from gateway.codec.picture import COMPRESSED_IMAGE, IMAGE
from gateway.codec.types import Types
from gateway.sources.graph import Graph, ServerInfo, TopicInfo
from gateway.sources.source import Qos, RosError
from gateway.sources.zenoh.action_wire import ActionWire, action_wire
from gateway.sources.zenoh.actions import FEEDBACK_QOS, STATUS_QOS, STATUSES
from gateway.sources.zenoh.keys import DataKey
from gateway.sources.zenoh.requester import SERVICE_QOS
from gateway.sources.zenoh.tokens import EndpointKind
from schemas.definition import DefinitionError
from schemas.installed import UnknownTypeError
from schemas.type_hash import type_hash

DOMAIN: Final = 0  # of rmw_zenoh's wire, in the namespace of each robot
# image_transport ends the name of a camera's JPEGs by it.
JPEG_TOPIC: Final = "/compressed"
# It has what belongs to nodes that the role does not see.
OWN_NODE: Final = "/ros2_gateway_uplink"
# Relays publish on these by themselves, and it is about the relays.
OF_GATEWAYS: Final = frozenset({"/rosout", "/diagnostics", "/parameter_events"})
DESCRIBE: Final = "get_type_description"
DESCRIBE_TYPE: Final = "type_description_interfaces/srv/GetTypeDescription"
# Names and endpoints that one robot offers. A robot of 100 nodes has 2600.
MAX_ENTITIES: Final = 16_384

LATCHED: Final = Qos("reliable", "transient_local", "keep_last", 1)
PLAIN: Final = Qos("reliable", "volatile", "keep_last", 10)
_UNKNOWN: Final = (UnknownTypeError, DefinitionError, RosError)


class Entity(NamedTuple):
    """A node of the robot, or an endpoint of one."""

    node: str
    kind: EndpointKind | None = None  # None: the node itself
    key: DataKey | None = None
    qos: Qos | None = None
    number: int = 0  # of those of a node that are alike


@dataclass(frozen=True, slots=True)
class OfferedTopic:
    """A topic as viewers see it, and what it is made of."""

    key: DataKey
    source: str
    is_latched: bool
    is_picture: bool  # encoded here


@dataclass(slots=True)
class Offer:
    """All that is offered now."""

    topics: dict[str, OfferedTopic] = field(default_factory=dict)
    inputs: dict[str, DataKey] = field(default_factory=dict)  # that nodes subscribe to
    services: dict[str, str] = field(default_factory=dict)  # the type by name
    actions: dict[str, str] = field(default_factory=dict)
    entities: dict[Entity, None] = field(default_factory=dict)
    left_out: int = 0  # of `MAX_ENTITIES`

    def add(self, *entities: Entity) -> None:
        """Add entities, as many as there may be."""
        for each in entities:
            if len(self.entities) < MAX_ENTITIES:
                self.entities[each] = None
            else:
                self.left_out += 1


class Offering:
    """Finds out what is offered.

    Topics of *commands* move the robot. Viewers see that nodes listen on these, and nothing passes.
    """

    def __init__(self, types: Types, commands: Collection[str]) -> None:
        self._types, self._commands = types, frozenset(commands)
        self._hashes: dict[str, str | None] = {}
        self._wires: dict[str, ActionWire] = {}
        self._revision = types.definitions.revision

    async def prepare(self, graph: Graph) -> None:
        """Read the types of a graph, with turns for other work: all of them take 0.3 s."""
        kinds = ((graph.topics, self.hash_of), (graph.services, self._service_hash_of))
        for named, read in (*kinds, (graph.actions, self._wire_of)):
            for type_name in dict.fromkeys(each for one in named for each in one.types):
                read(type_name)
                await asyncio.sleep(0)

    def of(self, graph: Graph, sees: Callable[[str], bool]) -> Offer:
        """Return what is offered of a graph. Names that the role does not see are left out."""
        self._follow_definitions()
        offer = Offer()
        describing = self.service_key(f"/{DESCRIBE}", DESCRIBE_TYPE)
        for node in (OWN_NODE, *filter(sees, graph.nodes)):
            offer.add(Entity(node))
            if describing is not None:  # also of a node that tells nothing
                name = f"{node.rstrip('/')}/{DESCRIBE}"
                offer.add(Entity(node, "SS", describing._replace(name=name), SERVICE_QOS))
        names = {each.name for each in graph.topics}
        for topic in graph.topics:
            if sees(topic.name):
                self._add_topic(offer, _without_hidden(topic, sees), names)
        for service in graph.services:
            if sees(service.name):
                self._add_service(offer, _served(service, sees))
        for action in graph.actions:
            if sees(action.name):
                self._add_action(offer, _served(action, sees))
        return offer

    def _follow_definitions(self) -> None:
        if self._revision != self._types.definitions.revision:
            self._revision = self._types.definitions.revision
            self._hashes.clear()
            self._wires.clear()

    def service_key(self, name: str, type_name: str) -> DataKey | None:
        """Return the key of a service, unless its type is not known."""
        known = self._service_hash_of(type_name)
        return None if known is None else DataKey(DOMAIN, name, type_name, known)

    def _service_hash_of(self, type_name: str) -> str | None:
        try:
            return self._types.service(type_name).definition.type_hash
        except _UNKNOWN:
            return None

    def _wire_of(self, type_name: str) -> ActionWire | None:
        if type_name not in self._wires:
            try:
                self._wires[type_name] = action_wire(self._types, type_name)
            except _UNKNOWN:
                return None
        return self._wires[type_name]

    def _add_topic(self, offer: Offer, topic: TopicInfo, names: Collection[str]) -> None:
        type_name = next(iter(topic.types), "")
        name = topic.name
        is_picture = type_name == IMAGE
        if is_picture:
            name, type_name = name + JPEG_TOPIC, COMPRESSED_IMAGE
            if name in names:  # a camera has its own JPEGs
                return
        known = self.hash_of(type_name)
        if known is None:
            return
        key = DataKey(DOMAIN, name, type_name, known)
        if name in self._commands:  # so that pages see that there is a robot to drive
            offer.add(*_alike(topic.subscribers, "MS", key, PLAIN))
            return
        if topic.publishers:
            offer.topics[name] = OfferedTopic(key, topic.name, topic.is_latched, is_picture)
            qos = LATCHED if topic.is_latched else PLAIN
            offer.add(*_alike(topic.publishers, "MP", key, qos))
        if not is_picture and topic.subscribers:
            if name not in OF_GATEWAYS:
                offer.inputs[name] = key
            offer.add(*_alike(topic.subscribers, "MS", key, PLAIN))

    def _add_service(self, offer: Offer, service: ServerInfo) -> None:
        type_name = next(iter(service.types), "")
        key = self.service_key(service.name, type_name)
        if key is not None and type_name != DESCRIBE_TYPE:
            offer.services[service.name] = type_name
            offer.add(*(Entity(node, "SS", key, SERVICE_QOS) for node in service.nodes))

    def _add_action(self, offer: Offer, action: ServerInfo) -> None:
        type_name = next(iter(action.types), "")
        before = f"{action.name}/_action"
        wire, statuses = self._wire_of(type_name), self.hash_of(STATUSES)
        feedback = None if wire is None else self.hash_of(wire.feedback_type)
        if wire is None or statuses is None or feedback is None:
            return
        offer.actions[action.name] = type_name
        parts = (("get_result", wire.get_result), ("cancel_goal", wire.cancel))
        topics = (
            ("feedback", wire.feedback_type, feedback, FEEDBACK_QOS),
            ("status", STATUSES, statuses, STATUS_QOS),
        )
        for node in action.nodes:
            for name, each, known, qos in topics:
                key = DataKey(DOMAIN, f"{before}/{name}", each, known)
                offer.add(Entity(node, "MP", key, qos))
            # the first one that clients use comes last: they find the rest
            for name, part in (*parts, ("send_goal", wire.send_goal)):
                key = DataKey(DOMAIN, f"{before}/{name}", part.type_name, part.type_hash)
                offer.add(Entity(node, "SS", key, SERVICE_QOS))

    def hash_of(self, type_name: str) -> str | None:
        """Return the hash of a message type, unless it is not known."""
        if type_name not in self._hashes:
            self._hashes[type_name] = self._new_hash_of(type_name)
        return self._hashes[type_name]

    def _new_hash_of(self, type_name: str) -> str | None:
        try:
            return type_hash(self._types.get(type_name).definition, self._types.definitions)
        except _UNKNOWN:
            return None


def _without_hidden(topic: TopicInfo, sees: Callable[[str], bool]) -> TopicInfo:
    if all(map(sees, (*topic.publishers, *topic.subscribers))):
        return topic
    publishers, subscribers = (
        tuple(each if sees(each) else OWN_NODE for each in nodes)
        for nodes in (topic.publishers, topic.subscribers)
    )
    return replace(topic, publishers=publishers, subscribers=subscribers)


def _served(server: ServerInfo, sees: Callable[[str], bool]) -> ServerInfo:
    """Return a server with a node that relays may know."""
    if server.nodes and all(map(sees, server.nodes)):
        return server
    return replace(server, nodes=tuple(filter(sees, server.nodes)) or (OWN_NODE,))


def _alike(nodes: Iterable[str], kind: EndpointKind, key: DataKey, qos: Qos) -> Iterator[Entity]:
    """Yield an endpoint for each time that a node is there."""
    known: dict[str, int] = {}
    for node in nodes:
        number = known[node] = known.get(node, -1) + 1
        yield Entity(node, kind, key, qos, number)
