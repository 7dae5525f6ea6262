# SPDX-License-Identifier: Apache-2.0
"""The definitions in a node's answer about a type, as type_description_interfaces has it.

A description has all that a type's hash covers (REP-2011). The source texts, which the node was
built from, also have comments and constants. A reader must compare the hash, because a node can say
anything.
"""

import contextlib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Final

from schemas.definition import Definition, DefinitionError, FieldType
from schemas.definition_text import parse_definition
from schemas.idl import parse_idl_message
from schemas.type_hash import PLACEHOLDER, field_type_of, individual_description

MAX_DESCRIBED_TYPES: Final = 256  # that one type nests. Robots' types have ten or so
MAX_TEXT_CHARACTERS: Final = 256 * 1024  # of each, as in a file
_PARSERS: Final = {"msg": parse_definition, "idl": parse_idl_message}


def described_definitions(answer: Mapping[str, Any]) -> dict[str, Definition]:
    """Read the answer of GetTypeDescription: the type that was asked for first, then nested ones.

    Raises:
        DefinitionError: one cannot be read, or there are too many or too long ones.
    """
    description = answer["type_description"]
    nested = description["referenced_type_descriptions"]
    if len(nested) > MAX_DESCRIBED_TYPES:
        raise DefinitionError(f"nests {len(nested)} types, at most {MAX_DESCRIBED_TYPES} are read")
    texts = {each["type_name"]: each for each in answer["type_sources"]}
    definitions = {}
    for each in (description["type_description"], *nested):
        name = each["type_name"]
        definitions[name] = _definition(name, each["fields"], texts.get(name, {}))
    return definitions


def _definition(
    name: str, fields: Sequence[Mapping[str, Any]], source: Mapping[str, Any]
) -> Definition:
    """Read the source if it says what the description says, else the description."""
    described = _described(name, fields)
    parse = _PARSERS.get(source.get("encoding", ""))
    text = source.get("raw_file_contents", "")
    if parse is not None and 0 < len(text) <= MAX_TEXT_CHARACTERS:
        with contextlib.suppress(DefinitionError):  # rosidl leaves the quotes of IDL out
            found = parse(name, text)
            if individual_description(found) == individual_description(described):
                return found
    return described


def _described(name: str, fields: Sequence[Mapping[str, Any]]) -> Definition:
    """Read a description as a `.msg` file, whose parser finds out what the names are worth."""
    types = {
        each["name"]: _type(name, each["type"])
        for each in fields
        if each["name"] != PLACEHOLDER.name
    }
    text = "".join(f"{type_} {field}\n" for field, type_ in types.items())
    if len(text) > MAX_TEXT_CHARACTERS:
        raise DefinitionError(f"{name}: its text has over {MAX_TEXT_CHARACTERS} characters")
    read = parse_definition(name, text)
    # a `.msg` file has no word for the char of IDL
    typed = (replace(field, type=types.get(field.name, field.type)) for field in read.fields)
    return replace(read, fields=tuple(typed))


def _type(name: str, described: Mapping[str, Any]) -> FieldType:
    try:
        return field_type_of(described)
    except LookupError:
        problem = f"a field has the type {described['type_id']}, which no ROS message has"
        raise DefinitionError(f"{name}: {problem}") from None
