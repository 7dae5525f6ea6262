# SPDX-License-Identifier: Apache-2.0
"""The services about types: what is installed, and what it consists of."""

import difflib
from collections.abc import Callable, Mapping
from functools import partial

from gateway.codec.words import MAX_ECHO, cut
from gateway.protocol.errors import ProtocolError
from gateway.rosapi.graph import GraphServices, full_type
from gateway.rosapi.typedefs import full_text, typedefs
from schemas.definition import DefinitionError
from schemas.installed import InstalledDefinitions, Kind, UnknownTypeError
from schemas.interface import InterfaceKind, Role, part_name
from schemas.table import TypeSpellingError, resolve_interface

_Request = Mapping[str, str]
_Answer = dict[str, object]


class TypeServices:
    """The services about types.

    A type that is none is an error, because clients take the first of the typedefs unseen.
    """

    def __init__(self, graph: GraphServices, definitions: InstalledDefinitions) -> None:
        self._graph = graph
        self._definitions = definitions
        self._names: dict[Kind, list[str]] = {}

    def topics_and_raw_types(self, _: _Request) -> _Answer:
        """List the topics, the first type of each, and the full text of that."""
        found = self._graph.types_of_topics()
        texts = {name: self._text(name) for name in set(found.values())}
        return {
            "topics": list(found),
            "types": list(found.values()),
            "typedefs_full_text": [texts[name] for name in found.values()],
        }

    def interfaces(self, _: _Request) -> _Answer:
        """List the messages, services and actions that are installed."""
        kinds: tuple[Kind, ...] = ("msg", "srv", "action")
        return {"interfaces": sorted(name for kind in kinds for name in self._installed(kind))}

    def message_details(self, request: _Request) -> _Answer:
        """Describe a message.

        Raises:
            ProtocolError: it is none, or not installed.
        """
        name = full_type(request["type"], "msg")
        return self._typedefs(name, name, "msg")

    def details(self, kind: InterfaceKind, role: Role) -> Callable[[_Request], _Answer]:
        """Return the service that describes one message of a service or an action.

        It raises like `message_details`.
        """
        return partial(self._details, kind, role)

    def _details(self, kind: InterfaceKind, role: Role, request: _Request) -> _Answer:
        try:
            name = resolve_interface(request["type"], kind)
        except TypeSpellingError as error:
            raise _bad_type(error) from error
        return self._typedefs(part_name(name, role), name, kind)

    def _typedefs(self, message: str, within: str, kind: Kind) -> _Answer:
        try:
            return {"typedefs": typedefs(message, self._definitions)}
        except UnknownTypeError as error:
            near = difflib.get_close_matches(within[:MAX_ECHO], self._installed(kind), n=1)
            raise _bad_type(error, f"; did you mean {near[0]}?" if near else "") from error
        except DefinitionError as error:
            raise _bad_type(error) from error

    def _text(self, name: str) -> str:
        try:
            return full_text(name, self._definitions)
        except (UnknownTypeError, DefinitionError) as error:
            return f"# {error}\n"

    def _installed(self, kind: Kind) -> list[str]:
        # Reading the directories takes milliseconds, and what is in them stays.
        if kind not in self._names:
            self._names[kind] = self._definitions.names(kind=kind)
        return self._names[kind]


def _bad_type(error: Exception, hint: str = "") -> ProtocolError:
    return ProtocolError("bad_type", f"type: {cut(str(error))}{hint}")
