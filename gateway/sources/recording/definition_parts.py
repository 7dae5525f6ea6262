# SPDX-License-Identifier: Apache-2.0
"""Definitions in one text, as recordings have them.

The first part is of the type itself. A line of ``=`` and a line with a name precede each other one.
"""

import re
from collections.abc import Iterator, Mapping
from typing import Final, Literal

from schemas.definition import Definition
from schemas.definition_text import parse_definition
from schemas.idl import parse_idl_message

Notation = Literal["msg", "idl"]

_RULER: Final = re.compile(r"^={80}\n", re.MULTILINE)
_TITLE: Final = re.compile(r"(?:MSG|IDL): (?P<name>\S+)\s*\n")
_PARSERS: Final = {"msg": parse_definition, "idl": parse_idl_message}


def parse_parts(type_name: str, text: str, notation: Notation) -> Mapping[str, Definition]:
    """Return the definition of a message type, and those of the types that it nests.

    Raises:
        DefinitionError: a part cannot be parsed.
    """
    parse = _PARSERS[notation]
    return {name: parse(name, part) for name, part in _parts(type_name, text)}


def differs(known: Mapping[str, Definition], name: str, definition: Definition) -> bool:
    """Return whether another definition of a type is known. Comments do not count."""
    other = known.get(name)
    return other is not None and _layout(other) != _layout(definition)


def _layout(definition: Definition) -> list[object]:
    return [(field.name, field.type) for field in definition.fields]


def _parts(type_name: str, text: str) -> Iterator[tuple[str, str]]:
    for part in _RULER.split(text.replace("\r\n", "\n")):
        title = _TITLE.match(part)
        if title is not None:
            package, *_, name = title["name"].split("/")
            yield f"{package}/msg/{name}", part[title.end() :]
        elif part.strip() or "\n" not in text.strip():
            yield type_name, part
