# SPDX-License-Identifier: Apache-2.0
"""The size of a type, which bounds the time and the memory that a definition can take."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from schemas.definition import Definition, DefinitionError, FieldType

# In each message, by arrays of fixed length: a line can state any number, and each gets its room.
MAX_VALUES: Final = 50_000
# Of a type and all that it nests, each time that it does: each takes 60 us to compile, and the
# largest public types, goals of MoveIt, have 700.
MAX_FIELDS: Final = 2000
_OCTETS_PER_VALUE: Final = 200  # so 10 MB, as a client may send


@dataclass(frozen=True, slots=True)
class TypeSize:
    """The size of a type: the values that each message has at least, and the fields to compile."""

    values: int
    fields: int  # those of a nested type count each time, because codecs have each place of it


def size_of(definition: Definition, nested: Mapping[str, TypeSize]) -> TypeSize:
    """Return the size of a type, given those of the types that it nests.

    Raises:
        DefinitionError: it is larger than `MAX_VALUES` or `MAX_FIELDS` allow.
    """
    name = definition.name
    values = sum(_values_of(field.type, nested) for field in definition.fields)
    inner = (nested[field.type.base] for field in definition.fields if field.type.base in nested)
    fields = len(definition.fields) + sum(each.fields for each in inner)
    if values > MAX_VALUES:
        text = f"{name}: each message has over {MAX_VALUES} values, by its fixed arrays"
        raise DefinitionError(text)
    if fields > MAX_FIELDS:
        raise DefinitionError(f"{name}: over {MAX_FIELDS} fields, nested ones included")
    return TypeSize(values, fields)


def _values_of(type_: FieldType, nested: Mapping[str, TypeSize]) -> int:
    size = nested.get(type_.base)
    each = 1 if size is None else size.values
    if type_.is_sequence:
        return 1
    if type_.length is None:
        return each
    if type_.is_octets:
        return type_.length // _OCTETS_PER_VALUE
    return type_.length * max(1, each)  # also of an empty type
