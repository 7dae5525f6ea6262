# SPDX-License-Identifier: Apache-2.0
"""Message types by name, by number, or as the ROS graph has them."""

from collections.abc import Callable

from gateway.codec.types import MessageType, Types
from gateway.core.bad_type import bad_type
from gateway.core.errors import ProtocolError
from gateway.core.names import TopicName
from gateway.sources.source import Ros
from schemas.definition import DefinitionError
from schemas.installed import UnknownTypeError
from schemas.table import Table, TypeNameError, resolve_type


class TypeAskedError(ProtocolError):
    """The definition of a type is not known, and is being asked for."""

    def __init__(self, type_name: str) -> None:
        self.question = f"the definition of {type_name} is being asked for"
        super().__init__("bad_type", f"type: {self.question}: try again in a moment")


class TopicTypes:
    """Finds the message type that a client asks for, or that a topic has.

    *ask* gets a type of the graph, has it learned if it is not known, and returns whether that is
    under way.
    """

    def __init__(
        self,
        ros: Ros,
        types: Types,
        table: Table,
        ask: Callable[[str], bool] = lambda _: False,
    ) -> None:
        self._ros = ros
        self._ask = ask
        self._types = types
        self._table = table

    def named(self, requested: str | int) -> MessageType:
        """Return the type that a client names, as a name or a number of the table.

        Raises:
            ProtocolError: the name is malformed, or the type is not installed here.
        """
        try:
            return self.get(resolve_type(requested, self._table))
        except TypeNameError as error:
            raise bad_type(error, self._types.definitions) from error

    def get(self, type_name: str) -> MessageType:
        """Return an installed type by its full name.

        Raises:
            ProtocolError: it, or a type that it nests, is not installed here, or is unreadable.
        """
        try:
            return self._types.get(type_name)
        except (UnknownTypeError, DefinitionError) as error:
            raise bad_type(error, self._types.definitions) from error

    def known(self, topic: TopicName) -> tuple[str, ...]:
        """Return the types that ROS knows for a topic."""
        return self._ros.topic_types(topic)

    def on_topic(self, topic: TopicName, requested: str | int | None) -> MessageType | None:
        """Return the type to use on a topic. ``None`` if neither client nor ROS names one yet.

        Raises:
            ProtocolError: the type is not installed, contradicts the topic's, or must be chosen.
            TypeAskedError: its definition may be known soon.
        """
        known = self._ros.topic_types(topic)
        for type_name in known:
            if self._ask(type_name) and requested in {None, type_name}:
                raise TypeAskedError(type_name)
        if requested is not None:
            named = self.named(requested)
            if known and named.name not in known:
                raise ProtocolError(
                    "type_conflict",
                    f"topic {topic} has type {' and '.join(known)}, not {named.name}",
                )
            return named
        match known:
            case ():
                return None
            case (only,):
                return self.get(only)
        raise ProtocolError(
            "type_conflict", f"topic {topic} has types {' and '.join(known)}: choose one by `type`"
        )

    def number(self, type_name: str) -> int | None:
        """Return a type's number in the list of message types, if it has one."""
        row = self._table.by_name.get(type_name)
        return None if row is None else row.number
