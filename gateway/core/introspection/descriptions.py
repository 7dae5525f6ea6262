# SPDX-License-Identifier: Apache-2.0
"""Types as `describe` shows them, by their own name or by that of what has them."""

from collections.abc import Sequence
from typing import Any, NamedTuple

from gateway.codec.error_text import nearest, suggestion, truncate
from gateway.codec.types import ActionType, MessageType, ServiceType
from gateway.core.errors import ProtocolError
from gateway.core.interface_types import InterfaceTypes
from gateway.core.introspection.examples import (
    EXAMPLE_TOPICS,
    call_frame,
    goal_frame,
    publish_frame,
)
from gateway.core.session import Session
from gateway.core.topic_types import TopicTypes
from gateway.sources.graph import Graph, ServerInfo, TopicInfo
from schemas.definition import Definition
from schemas.installed import InstalledDefinitions
from schemas.interface import Interface
from schemas.type_hash import type_hash

Type = MessageType | ServiceType | ActionType


class Description(NamedTuple):
    """A frame to paste, where there is one, and the members of the answer."""

    example: dict[str, Any] | None
    members: dict[str, Any]


class _Named(NamedTuple):
    """A topic, a service or an action of the graph."""

    name: str
    types: Sequence[str]


class Descriptions:
    """Describes message, service and action types, with a frame to paste."""

    def __init__(
        self,
        topic_types: TopicTypes,
        interface_types: InterfaceTypes,
        definitions: InstalledDefinitions,
    ) -> None:
        self._topic_types = topic_types
        self._interface_types = interface_types
        self.definitions = definitions

    def describe(self, session: Session, requested: str | int, graph: Graph) -> Description:
        """Describe a type. *graph* has the names that the client may see.

        Raises:
            ProtocolError: it names no installed type, and nothing in the graph.
        """
        if isinstance(requested, str) and requested.startswith("/"):
            named = _in_graph(requested, graph)
            if named is None:
                raise self._unknown_name(requested, graph)
            return self._described(session, self._type_of(named), named.name, graph)
        try:
            found = self._type(requested)
        except ProtocolError:
            # clients may leave out the slash of a name
            named = _in_graph(f"/{requested}", graph)
            if named is None:
                raise
            return self._described(session, self._type_of(named), named.name, graph)
        return self._described(session, found, None, graph)

    def _type(self, requested: str | int) -> Type:
        try:
            return self._topic_types.named(requested)
        except ProtocolError as error:
            found = self._interface_types.described(requested)
            if found is not None:
                return found
            near = self._interface_types.meant(requested)
            if near is None:
                raise
            raise ProtocolError(error.code, f"{error}{suggestion(near)}") from error

    def _type_of(self, named: _Named) -> Type:
        if len(named.types) != 1:
            types = " and ".join(named.types)
            raise ProtocolError("type_conflict", f"{named.name} has types {types}: describe one")
        return self._type(named.types[0])

    def _described(
        self, session: Session, found: Type, name: str | None, graph: Graph
    ) -> Description:
        members: dict[str, Any] = {} if name is None else {"name": name}
        members["type"] = found.name
        if isinstance(found, MessageType):
            members["number"] = self._topic_types.number(found.name)
        members |= self._definition(found.definition) | {"schema": found.json_schema()}
        return Description(self._example(session, found, name, graph), members)

    def _example(
        self, session: Session, found: Type, name: str | None, graph: Graph
    ) -> dict[str, Any] | None:
        """Return a frame to paste. ``None`` if the type is of a service that nobody provides."""
        match found:
            case MessageType():
                topic = name or EXAMPLE_TOPICS + found.name
                return publish_frame(found, self.definitions, topic)
            case ServiceType():
                name = name or _provided(session, graph.services, found.name)
                return None if name is None else call_frame(name, found, self.definitions)
            case ActionType():
                name = name or _provided(session, graph.actions, found.name)
                return None if name is None else goal_frame(name, found, self.definitions)

    def _definition(self, definition: Definition | Interface) -> dict[str, str | None]:
        known = definition.type_hash
        if known is None and isinstance(definition, Definition):
            known = type_hash(definition, self.definitions)
        return {"type_hash": known, "definition": definition.text}

    def _unknown_name(self, requested: str, graph: Graph) -> ProtocolError:
        name = truncate(requested)
        known = [each.name for each in _entries(graph)]
        below = (each for each in known if each.startswith(f"{name}/"))
        guess = nearest(name, known) or next(below, None) or self.definitions.meant(requested)
        hint = suggestion(guess)
        return ProtocolError("not_found", f"no topic, service or action is called {name}{hint}")


def _in_graph(name: str, graph: Graph) -> _Named | None:
    found = (each for each in _entries(graph) if each.name == name)
    return next((_Named(each.name, each.types) for each in found), None)


def _entries(graph: Graph) -> tuple[TopicInfo | ServerInfo, ...]:
    return (*graph.topics, *graph.services, *graph.actions)


def _provided(session: Session, servers: Sequence[ServerInfo], type_name: str) -> str | None:
    """Return the name of a server of a type that the client may call."""
    names = (each.name for each in servers if each.types == (type_name,))
    return next((name for name in names if session.may("call", name)), None)
