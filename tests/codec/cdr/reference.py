# SPDX-License-Identifier: Apache-2.0
"""CDR, slowly and obviously: field by field, value by value, as the standard words it."""

import struct
from typing import Any

from schemas.definition import Definition, FieldType
from schemas.installed import InstalledDefinitions
from tests.messages import Plain

CODES = {
    "bool": "?",
    "byte": "B",
    "char": "B",
    "int8": "b",
    "uint8": "B",
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
    "float32": "f",
    "float64": "d",
}


class Writer:
    """Writes the plain form as CDR, with any byte order and with any octet as padding."""

    def __init__(
        self, definitions: InstalledDefinitions, order: str = "<", padding: int = 0
    ) -> None:
        self._definitions = definitions
        self._order = order
        self._padding = padding
        self._out = bytearray()

    def message(self, definition: Definition, values: Plain) -> bytes:
        self._out = bytearray()
        self._fields(definition, values)
        return (b"\0\1\0\0" if self._order == "<" else b"\0\0\0\0") + self._out

    def _fields(self, definition: Definition, values: Plain) -> None:
        if not definition.fields:
            self._primitive("uint8", self._padding)
        for field in definition.fields:
            self._value(field.type, values[field.name])

    def _value(self, kind: FieldType, value: Any) -> None:
        if not kind.is_array:
            self._one(kind, value)
            return
        if kind.is_sequence:
            self._primitive("uint32", len(value))
        for item in value:
            self._one(kind, item)

    def _one(self, kind: FieldType, value: Any) -> None:
        if kind.base == "string":
            data = value.encode() + b"\0"
            self._primitive("uint32", len(data))
            self._out += data
        elif kind.base == "wstring":
            units = value.encode("utf-16-be")
            self._primitive("uint32", len(units) // 2)
            for high, low in zip(units[::2], units[1::2], strict=True):
                self._primitive("uint32", high * 256 + low)
        elif kind.is_primitive:
            self._primitive(kind.base, value)
        else:
            self._fields(self._definitions.get(kind.base), value)

    def _primitive(self, base: str, value: Any) -> None:
        code = self._order + CODES[base]
        while len(self._out) % struct.calcsize(code):
            self._out.append(self._padding)
        self._out += struct.pack(code, value)
