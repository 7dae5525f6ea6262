# SPDX-License-Identifier: Apache-2.0
"""Types, as rosapi describes them: fields, examples and constants in parallel lists."""

from typing import Final

from schemas.definition import FLOATS, INTEGER_RANGES, Definition, Field
from schemas.installed import InstalledDefinitions

# IDL's names of the types of .msg files. rosbridge on ROS 2 sends these, from rosidl's Python.
_IDL_NAMES: Final = {
    "bool": "boolean",
    "byte": "octet",
    "char": "uint8",
    "float32": "float",
    "float64": "double",
}
# Between the definitions in a text of several, as in ROS 1's `gendeps --cat`.
_RULER: Final = "=" * 80


def typedefs(name: str, definitions: InstalledDefinitions) -> list[dict[str, object]]:
    """Return the rosapi_msgs/msg/TypeDef of a message, then those of all nested types.

    Raises:
        UnknownTypeError, DefinitionError: as for `InstalledDefinitions.closure`.
    """
    return [_typedef(definition) for definition in reversed(definitions.closure([name]))]


def full_text(name: str, definitions: InstalledDefinitions) -> str:
    """Return the definition text of a message, followed by those of all nested types.

    Raises:
        UnknownTypeError, DefinitionError: as for `InstalledDefinitions.closure`.
    """
    *nested, own = definitions.closure([name])
    texts = [own.text]
    texts += [f"{_RULER}\nMSG: {_title(each.name)}\n{each.text}" for each in reversed(nested)]
    return "\n".join(texts)


def _typedef(definition: Definition) -> dict[str, object]:
    fields = definition.fields
    return {
        "type": _title(definition.name),
        "fieldnames": [field.name for field in fields],
        "fieldtypes": [_type_name(field.type.base) for field in fields],
        "fieldarraylen": [_array_length(field) for field in fields],
        "examples": [_example(field) for field in fields],
        "constnames": [constant.name for constant in definition.constants],
        "constvalues": [str(constant.value) for constant in definition.constants],
    }


def _title(name: str) -> str:
    # roslib looks fields up by it: it must be equal in `type` and in `fieldtypes`
    package, _, short_name = name.split("/")
    return f"{package}/{short_name}"


def _type_name(base: str) -> str:
    return _title(base) if "/" in base else _IDL_NAMES.get(base, base)


def _array_length(field: Field) -> int:
    if field.type.is_sequence:
        return 0
    return -1 if field.type.length is None else field.type.length


def _example(field: Field) -> str:
    if field.type.is_array:
        return "[]"
    if field.default is not None:
        return str(field.default)
    base = field.type.base
    if base in INTEGER_RANGES:
        return "0"
    if base in FLOATS:
        return "0.0"
    if base == "bool":
        return "False"
    return "" if field.type.is_primitive else "{}"
