# SPDX-License-Identifier: Apache-2.0
"""The REP-2011 hash of a message type, computed if none is installed.

ROS 2 before Iron installs no hashes. The hash covers names, types and order of the fields, of
the type and of all nested types. Defaults, constants and comments do not change it.
"""

import hashlib
import json
from collections.abc import Iterable, Mapping
from typing import Any, Final, Protocol

from schemas.definition import Definition, Field, FieldType

# type_description_interfaces/msg/FieldType: the id of a single value ...
_NESTED: Final = 1
_IDS: Final = {
    "int8": 2,
    "uint8": 3,
    "int16": 4,
    "uint16": 5,
    "int32": 6,
    "uint32": 7,
    "int64": 8,
    "uint64": 9,
    "float32": 10,
    "float64": 11,
    "char": 13,
    "bool": 15,
    "byte": 16,
    "string": 17,
    "wstring": 18,
}
_BOUNDED_STRINGS: Final = {"string": 21, "wstring": 22}
# ... and the number added to it for several.
_FIXED_ARRAY: Final = 48
_BOUNDED_SEQUENCE: Final = 96
_SEQUENCE: Final = 144

_NAMES: Final = {number: name for name, number in _IDS.items()}
_NAMES_OF_BOUNDED: Final = {number: name for name, number in _BOUNDED_STRINGS.items()}

# IDL has no empty structure, so a message without fields gets this one.
PLACEHOLDER: Final = Field("structure_needs_at_least_one_member", FieldType("uint8"))


class Definitions(Protocol):
    """An object that knows the types that a definition nests."""

    def closure(self, names: Iterable[str]) -> list[Definition]:
        """Return the definitions of *names* and of all nested types."""


def type_hash(definition: Definition, definitions: Definitions) -> str:
    """Return the hash installed with *definition*, or compute it.

    Raises:
        UnknownTypeError: a type that it nests is not installed.
    """
    if definition.type_hash is not None:
        return definition.type_hash
    return computed_type_hash(definition, definitions)


def computed_type_hash(definition: Definition, definitions: Definitions) -> str:
    """Compute the hash of *definition* (REP-2011, version 1: SHA-256 of its description).

    Raises:
        UnknownTypeError: a type that it nests is not installed.
    """
    # The hashed text is part of the standard, separators included.
    text = json.dumps(type_description(definition, definitions), separators=(", ", ": "))
    return f"RIHS01_{hashlib.sha256(text.encode()).hexdigest()}"


def type_description(definition: Definition, definitions: Definitions) -> dict[str, Any]:
    """Return what a node says of a type: a type_description_interfaces/msg/TypeDescription.

    It has no default values, which do not change the hash.

    Raises:
        UnknownTypeError: a type that it nests is not installed.
    """
    nested = definitions.closure(definition.nested())
    return {
        "type_description": individual_description(definition),
        "referenced_type_descriptions": [
            individual_description(other) for other in sorted(nested, key=lambda other: other.name)
        ],
    }


def field_type_of(described: Mapping[str, Any]) -> FieldType:
    """Return the type that a type_description_interfaces/msg/FieldType describes.

    Raises:
        LookupError: no type of ROS messages has its number.
    """
    number = described["type_id"] % _FIXED_ARRAY
    capacity = described["capacity"]
    forms: dict[int, dict[str, Any]] = {
        0: {},
        _FIXED_ARRAY: {"length": capacity},
        _BOUNDED_SEQUENCE: {"is_sequence": True, "bound": capacity},
        _SEQUENCE: {"is_sequence": True},
    }
    form = forms[described["type_id"] - number]
    if number == _NESTED:
        return FieldType(described["nested_type_name"], **form)
    if number in _NAMES_OF_BOUNDED:
        bound = described["string_capacity"]
        return FieldType(_NAMES_OF_BOUNDED[number], string_bound=bound, **form)
    return FieldType(_NAMES[number], **form)


def individual_description(definition: Definition) -> dict[str, Any]:
    """Return a type_description_interfaces/msg/IndividualTypeDescription of one type."""
    return {
        "type_name": definition.name,
        "fields": [
            {
                "name": field.name,
                "type": {
                    "type_id": _type_id(field.type),
                    "capacity": field.type.length or field.type.bound or 0,
                    "string_capacity": field.type.string_bound or 0,
                    "nested_type_name": "" if field.type.is_primitive else field.type.base,
                },
            }
            for field in definition.fields or (PLACEHOLDER,)
        ],
    }


def _type_id(field_type: FieldType) -> int:
    if field_type.string_bound is not None:
        single = _BOUNDED_STRINGS[field_type.base]
    else:
        single = _IDS.get(field_type.base, _NESTED)
    if field_type.length is not None:
        return single + _FIXED_ARRAY
    if not field_type.is_sequence:
        return single
    return single + (_SEQUENCE if field_type.bound is None else _BOUNDED_SEQUENCE)
