# SPDX-License-Identifier: Apache-2.0
"""The parts of definitions as TypeScript text: types, literals, comments."""

import json
import math
from typing import Final

from schemas.definition import FLOATS, STRINGS, FieldType, Scalar
from schemas.generate.request import Wire

# Reserved words that could be the name of a package. Those of fields need no care.
_RESERVED_LIST: Final = """
    any arguments as async await boolean break case catch class const continue debugger default
    delete do else enum eval export extends false finally for function if implements import in
    instanceof interface let module namespace never new null number object package private
    protected public require return static string super switch symbol this throw true try type
    typeof undefined unknown var void while with yield
"""
_RESERVED: Final = frozenset(_RESERVED_LIST.split())

_LONG: Final = frozenset({"int64", "uint64"})
# roslib 2 reads RFC 8746 like this. roslib 1 has plain arrays for the two of 64 bits.
_TYPED_ARRAYS: Final = {
    "int8": "Int8Array",
    "int16": "Int16Array",
    "uint16": "Uint16Array",
    "int32": "Int32Array",
    "uint32": "Uint32Array",
    "int64": "BigInt64Array",
    "uint64": "BigUint64Array",
    "float32": "Float32Array",
    "float64": "Float64Array",
}


def identifier(package: str) -> str:
    """Return the name of a package's module or name space."""
    return f"{package}_" if package in _RESERVED else package


def type_of(field_type: FieldType, wire: Wire, reference: str | None = None) -> str:
    """Return the type of a field. *reference* is the name of the interface that it nests."""
    if field_type.is_octets:
        return "globalThis.Uint8Array" if wire == "cbor" else "string"
    single = reference or _primitive(field_type.base, wire)
    if not field_type.is_array:
        return single
    if wire == "cbor" and field_type.base in _TYPED_ARRAYS:
        return f"globalThis.{_TYPED_ARRAYS[field_type.base]}"
    return f"({single})[]" if " " in single else f"{single}[]"


def remark(field_type: FieldType, wire: Wire) -> str:
    """Return the definition's type, and what the TypeScript type does not show of it."""
    notes = [f"`{field_type}`"]
    if wire == "json" and field_type.is_octets:
        notes.append("base64")
    elif wire == "json" and field_type.base in FLOATS:
        notes.append("null is NaN or an infinity")
    elif wire == "json" and field_type.base in _LONG:
        notes.append("rounded beyond 2^53")
    return ", ".join(notes)


def literal(base: str, value: Scalar) -> str:
    """Return the value of a constant."""
    if base in STRINGS:
        return json.dumps(str(value))
    if base == "bool":
        return "true" if value else "false"
    if base not in FLOATS:
        return str(value)
    number = float(value)
    if math.isnan(number):
        return "NaN"
    if math.isinf(number):
        return "Infinity" if number > 0 else "-Infinity"
    return repr(number)


def documentation(text: str) -> list[str]:
    """Return the lines of a comment for editors, which nothing in *text* can end."""
    printable = "".join(c for c in text.replace("\t", "    ") if c.isprintable() or c == "\n")
    lines = printable.replace("*/", "* /").split("\n")
    if len(lines) == 1:
        return [f"/** {lines[0]} */"]
    return ["/**", *(f" * {line}".rstrip() for line in lines), " */"]


def _primitive(base: str, wire: Wire) -> str:
    if base == "bool":
        return "boolean"
    if base in STRINGS:
        return "string"
    if base in FLOATS:
        return "number | null" if wire == "json" else "number"
    return "number | bigint" if wire == "cbor" and base in _LONG else "number"
