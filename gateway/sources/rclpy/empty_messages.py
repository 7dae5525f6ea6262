# SPDX-License-Identifier: Apache-2.0
"""CDR of messages in which every field has its default, for results that nobody has given."""

from struct import calcsize, pack

from gateway.sources.rclpy.realignment import CODES
from schemas.definition import Definition, Field, Scalar
from schemas.installed import InstalledDefinitions


def empty_message(
    definition: Definition, definitions: InstalledDefinitions, before: bytes = b""
) -> bytes:
    """Return *before* and an empty message behind it, little-endian, without encapsulation header.

    Raises:
        UnknownTypeError, DefinitionError: a type that it nests is not known.
    """
    nested = {each.name: each for each in definitions.closure(definition.nested())}
    writer = _Writer(before, nested)
    writer.write(definition)
    return bytes(writer.target)


class _Writer:
    def __init__(self, before: bytes, nested: dict[str, Definition]) -> None:
        self.target = bytearray(before)
        self._nested = nested

    def write(self, definition: Definition) -> None:
        if not definition.fields:  # rosidl adds one uint8, as IDL has no empty structure
            self._number("B", 0)
        for field in definition.fields:
            self._field(field)

    def _field(self, field: Field) -> None:
        base, length = field.type.base, field.type.length
        if not field.type.is_array:
            self._one(base, field.default)  # type: ignore[arg-type]  # no array has no tuple
            return
        values = field.default if isinstance(field.default, tuple) else ()
        if length is None:
            self._number("I", len(values))
        for value in values:
            self._one(base, value)
        left = 0 if values or length is None else length
        if base in CODES:  # there may be millions
            size = calcsize(CODES[base])
            self.target += bytes(-len(self.target) % size + size * left if left else 0)
        else:
            for _ in range(left):
                self._one(base, None)

    def _one(self, base: str, value: Scalar | None) -> None:
        if base == "string":
            octets = str(value or "").encode() + b"\0"
            self._number("I", len(octets))
            self.target += octets
        elif base == "wstring":  # UTF-16 units of 4 bytes each
            units = str(value or "").encode("utf-16-le")
            self._number("I", len(units) // 2)
            for at in range(0, len(units), 2):
                self.target += units[at : at + 2] + bytes(2)
        elif base in CODES:
            self._number(CODES[base], value or 0)
        else:
            self.write(self._nested[base])

    def _number(self, code: str, value: Scalar) -> None:
        self.target += bytes(-len(self.target) % calcsize(code)) + pack(f"<{code}", value)
