# SPDX-License-Identifier: Apache-2.0
"""The services about types: those installed, and their definitions."""

from collections.abc import Callable, Mapping
from functools import partial

from gateway.core.bad_type import bad_type
from gateway.core.rosapi.graph_services import GraphServices, full_type
from gateway.core.rosapi.typedefs import full_text, typedefs
from schemas.definition import DefinitionError
from schemas.installed import InstalledDefinitions, UnknownTypeError
from schemas.interface import InterfaceKind, Role, part_name
from schemas.table import TypeNameError, resolve_interface

_Request = Mapping[str, str]
_Answer = dict[str, object]


class TypeServices:
    """The services about types.

    An unknown type is an error, because clients take the first of the typedefs without a check.
    """

    def __init__(self, graph: GraphServices, definitions: InstalledDefinitions) -> None:
        self._graph = graph
        self._definitions = definitions

    def topics_and_raw_types(self, _: _Request) -> _Answer:
        """List the topics, the first type of each, and the full text of that type."""
        found = self._graph.types_of_topics()
        texts = {name: self._text(name) for name in set(found.values())}
        return {
            "topics": list(found),
            "types": list(found.values()),
            "typedefs_full_text": [texts[name] for name in found.values()],
        }

    def interfaces(self, _: _Request) -> _Answer:
        """List the messages, services and actions that are installed."""
        return {"interfaces": sorted(self._definitions.all_names())}

    def message_details(self, request: _Request) -> _Answer:
        """Describe a message.

        Raises:
            ProtocolError: the name is not a message type, or the type is not installed.
        """
        return self._typedefs(full_type(request["type"], "msg"))

    def details(self, kind: InterfaceKind, role: Role) -> Callable[[_Request], _Answer]:
        """Return the service that describes one message of a service or an action.

        It raises the same errors as `message_details`.
        """
        return partial(self._details, kind, role)

    def _details(self, kind: InterfaceKind, role: Role, request: _Request) -> _Answer:
        try:
            name = resolve_interface(request["type"], kind)
        except TypeNameError as error:
            raise bad_type(error, self._definitions) from error
        return self._typedefs(part_name(name, role))

    def _typedefs(self, message: str) -> _Answer:
        try:
            return {"typedefs": typedefs(message, self._definitions)}
        except (UnknownTypeError, DefinitionError) as error:
            raise bad_type(error, self._definitions) from error

    def _text(self, name: str) -> str:
        try:
            return full_text(name, self._definitions)
        except (UnknownTypeError, DefinitionError) as error:
            return f"# {error}\n"
