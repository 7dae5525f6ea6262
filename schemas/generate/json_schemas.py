# SPDX-License-Identifier: Apache-2.0
"""Write JSON Schemas (2020-12): a self-contained file per type, for messages on the wire.

They cover both directions: messages that the gateway sends, and all that it takes. The schema of a
service has its request and its response as properties, and likewise for actions.
"""

import json
import math
from collections.abc import Iterable, Mapping
from pathlib import PurePosixPath
from typing import Final

from schemas.definition import INTEGER_RANGES, Definition, Field, FieldType, Scalar, Value
from schemas.generate.catalogue import GENERATED, Catalogue
from schemas.interface import Interface, Role

Schema = dict[str, object]

SCHEMA_FOLDER: Final = PurePosixPath("schemas/json")

_DIALECT: Final = "https://json-schema.org/draft/2020-12/schema"
_NO_NUL: Final = "^[^\\u0000]*$"
_TIMES: Final = frozenset({"builtin_interfaces/msg/Duration", "builtin_interfaces/msg/Time"})
# The pattern is for strings alone, as bounds are for numbers.
_FLOAT: Final[Schema] = {"type": ["number", "null", "string"], "pattern": "^(NaN|-?Infinity)$"}
_ROS1_NAMES: Final = {"sec": "secs", "nanosec": "nsecs"}


def write(catalogue: Catalogue) -> dict[str, str]:
    """Return the schema of each row's type."""
    names = [*(row.name for row in catalogue.rows), *catalogue.interfaces]
    return {
        str(SCHEMA_FOLDER / file_name(name)): text_of(catalogue_schema(catalogue, name), GENERATED)
        for name in names
    }


def catalogue_schema(catalogue: Catalogue, name: str) -> Schema:
    """Return the schema of a message, a service or an action of a catalogue."""

    def schema(definition: Definition) -> Schema:
        nested = _closure(definition, catalogue.definitions)
        return schema_of(definition, nested, catalogue.hashes[definition.name])

    interface = catalogue.interfaces.get(name)
    if interface is None:
        return schema(catalogue.definitions[name])
    parts = {role: schema(part) for role, part in interface.parts.items()}
    return interface_schema(interface, parts)


def bundle(schemas: Iterable[Schema]) -> Schema:
    """Return one schema with others in its ``$defs``, by their titles with dots for slashes.

    It refuses nothing by itself: a user refers to ``#/$defs/geometry_msgs.msg.Twist``.
    """
    nested: Schema = {}
    whole: Schema = {}
    for schema in schemas:
        own = {key: value for key, value in schema.items() if key not in {"$schema", "$defs"}}
        whole[_key(str(schema["title"]))] = own
        found = schema.get("$defs")
        nested |= found if isinstance(found, dict) else {}
    return {"$schema": _DIALECT, "$defs": dict(sorted((nested | whole).items()))}


def text_of(schema: Schema, generated: str) -> str:
    """Return the text of a file. *generated* says how it was made."""
    return json.dumps({"$comment": generated, **schema}, indent=2, ensure_ascii=False) + "\n"


def file_name(name: str) -> PurePosixPath:
    """Return the path of a type's schema, relative to `SCHEMA_FOLDER`.

    It is ``pkg/Name.json`` for a message, ``pkg/srv/Name.json`` for a service.
    """
    package, kind, short_name = name.split("/")
    folder = PurePosixPath(package) if kind == "msg" else PurePosixPath(package, kind)
    return folder / f"{short_name}.json"


def schema_of(definition: Definition, nested: Iterable[Definition], type_hash: str) -> Schema:
    """Return the schema of one type. *nested* are all the types below it."""
    schema: Schema = {"$schema": _DIALECT, "title": definition.name}
    schema |= _message(definition)
    if definition.constants:
        schema["x-ros-constants"] = {
            constant.name: _finite(constant.value) for constant in definition.constants
        }
    schema["x-ros-type-hash"] = type_hash
    schemas = {_key(other.name): _message(other) for other in nested}
    if schemas:
        schema["$defs"] = dict(sorted(schemas.items()))
    return schema


def interface_schema(interface: Interface, parts: Mapping[Role, Schema]) -> Schema:
    """Return the schema of a service or an action, from those of its messages by role."""
    nested: Schema = {}
    properties: dict[str, Schema] = {}
    for role, part in parts.items():
        own = {key: value for key, value in part.items() if key not in {"$schema", "$defs"}}
        properties[role] = own
        nested_here = part.get("$defs")
        if isinstance(nested_here, dict):
            nested |= nested_here
    schema: Schema = {"$schema": _DIALECT, "title": interface.name}
    schema |= _object(properties) | {"required": list(properties)}
    if interface.type_hash is not None:
        schema["x-ros-type-hash"] = interface.type_hash
    if nested:
        schema["$defs"] = dict(sorted(nested.items()))
    return schema


def _closure(definition: Definition, known: Mapping[str, Definition]) -> list[Definition]:
    found: dict[str, Definition] = {}
    waiting = list(definition.nested())
    while waiting:
        name = waiting.pop()
        if name not in found:
            found[name] = known[name]
            waiting += known[name].nested()
    return list(found.values())


def _message(definition: Definition) -> Schema:
    schema: Schema = {"description": definition.comment} if definition.comment else {}
    properties = {field.name: _field(field) for field in definition.fields}
    if definition.name == "std_msgs/msg/Header":
        properties["seq"] = {"description": "As in ROS 1; ignored", "type": "integer"}
    this = schema | _object(properties)
    if definition.name not in _TIMES:
        return this
    ros1 = {_ROS1_NAMES.get(name, name): field for name, field in properties.items()}
    forms = [_object(properties), _object(ros1)]
    if definition.name == "builtin_interfaces/msg/Time":
        forms.append({"description": "The ROS time when it arrives", "const": "now"})
    return schema | {"anyOf": forms}


def _object(properties: Mapping[str, Schema]) -> Schema:
    return {"type": "object", "properties": dict(properties), "additionalProperties": False}


def _field(field: Field) -> Schema:
    described: Schema = {"description": field.comment} if field.comment else {}
    schema = described | _type(field.type)
    if field.default is not None and not field.type.is_octets:
        schema["default"] = _finite(field.default)
    return schema


def _type(field_type: FieldType) -> Schema:
    if field_type.is_octets:
        return _octets(field_type)
    if not field_type.is_array:
        return _single(field_type)
    return {"type": "array", "items": _single(field_type), **_sizes(field_type, "Items")}


def _single(field_type: FieldType) -> Schema:
    match field_type.base:
        case "bool":
            return {"type": "boolean"}
        case "float32":
            bound = 2.0**128 - 2.0**103  # from here, single precision rounds to infinity
            return _FLOAT | {"exclusiveMinimum": -bound, "exclusiveMaximum": bound}
        case "float64":
            return _FLOAT
        case "string" | "wstring":
            schema: Schema = {"type": "string", "pattern": _NO_NUL}
            if field_type.string_bound is not None:
                # In characters. The gateway counts UTF-8 bytes or UTF-16 units.
                schema["maxLength"] = field_type.string_bound
            return schema
        case base if base in INTEGER_RANGES:
            low, high = INTEGER_RANGES[base]
            return {"type": "integer", "minimum": low, "maximum": high}
        case base:
            return {"$ref": f"#/$defs/{_key(base)}"}


def _octets(field_type: FieldType) -> Schema:
    """Return the schema of base64 text, or of the integers themselves."""
    text: Schema = {"type": "string", "contentEncoding": "base64"}
    sizes = _sizes(FieldType("uint8", True, field_type.length, field_type.bound), "Length")
    text |= {name: math.ceil(size / 3) * 4 for name, size in sizes.items()}
    octet = {"type": "integer", "minimum": 0, "maximum": 255}
    return {"anyOf": [text, {"type": "array", "items": octet, **_sizes(field_type, "Items")}]}


def _sizes(field_type: FieldType, of: str) -> dict[str, int]:
    if field_type.length is not None:
        return {f"min{of}": field_type.length, f"max{of}": field_type.length}
    return {} if field_type.bound is None else {f"max{of}": field_type.bound}


def _key(name: str) -> str:
    return name.replace("/", ".")  # a slash would need escapes in every $ref


def _finite(value: Value) -> Scalar | list[Scalar | None] | None:
    """Return a value in JSON's form: numbers that are not finite are null."""
    if isinstance(value, tuple):
        return [None if isinstance(v, float) and not math.isfinite(v) else v for v in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
