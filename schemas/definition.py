# SPDX-License-Identifier: Apache-2.0
"""The definition of a ROS 2 message type: its fields, constants and comments."""

from dataclasses import dataclass
from typing import Final

INTEGER_RANGES: Final = {
    "int8": (-(2**7), 2**7 - 1),
    "uint8": (0, 2**8 - 1),
    "int16": (-(2**15), 2**15 - 1),
    "uint16": (0, 2**16 - 1),
    "int32": (-(2**31), 2**31 - 1),
    "uint32": (0, 2**32 - 1),
    "int64": (-(2**63), 2**63 - 1),
    "uint64": (0, 2**64 - 1),
    "byte": (0, 2**8 - 1),
    "char": (0, 2**8 - 1),  # of IDL alone: in `.msg` files the word means uint8
}
# The first double that rounds to infinity in single precision. The largest float32 is a
# little below, but prints as 3.4028235e38, which must come back in.
FLOAT32_OVERFLOW: Final = 2.0**128 - 2.0**103
FLOATS: Final = frozenset({"float32", "float64"})
STRINGS: Final = frozenset({"string", "wstring"})
PRIMITIVES: Final = frozenset(INTEGER_RANGES) | FLOATS | STRINGS | {"bool"}
OCTETS: Final = frozenset({"uint8", "byte", "char"})

Scalar = bool | int | float | str
Value = Scalar | tuple[Scalar, ...]


class DefinitionError(ValueError):
    """A message definition cannot be read. The text names the type, the line and the reason."""


@dataclass(frozen=True, slots=True)
class FieldType:
    """The type of a field: a primitive or ``pkg/msg/Name``, possibly an array of it.

    ``length`` is the size of a fixed array, ``bound`` the largest size of a sequence
    (``None``: unbounded), ``string_bound`` the largest length of a string.
    """

    base: str
    is_sequence: bool = False
    length: int | None = None
    bound: int | None = None
    string_bound: int | None = None

    @property
    def is_primitive(self) -> bool:
        """True if the type is built in and needs no other definition."""
        return self.base in PRIMITIVES

    @property
    def is_array(self) -> bool:
        """True for several values: a fixed array or a sequence."""
        return self.is_sequence or self.length is not None

    @property
    def is_octets(self) -> bool:
        """True for raw bytes, which are base64 on the wire."""
        return self.is_array and self.base in OCTETS

    def __str__(self) -> str:
        base = self.base if self.string_bound is None else f"{self.base}<={self.string_bound}"
        if self.length is not None:
            return f"{base}[{self.length}]"
        if self.is_sequence:
            return f"{base}[]" if self.bound is None else f"{base}[<={self.bound}]"
        return base


@dataclass(frozen=True, slots=True)
class Field:
    """One field of a message. ``default`` is ``None`` if the definition has no default."""

    name: str
    type: FieldType
    default: Value | None = None
    comment: str = ""
    is_key: bool = False  # DDS tells instances of the type apart by it. Only IDL can say so


@dataclass(frozen=True, slots=True)
class Constant:
    """One named constant of a message."""

    name: str
    type: str
    value: Scalar
    comment: str = ""


@dataclass(frozen=True, slots=True)
class Definition:
    """A message type: its full name (``pkg/msg/Name``), members, comments and `.msg` text.

    A part of a service or an action has rosidl's name for it: ``pkg/srv/Name_Request``.
    """

    name: str
    fields: tuple[Field, ...]
    constants: tuple[Constant, ...] = ()
    comment: str = ""
    text: str = ""
    type_hash: str | None = None  # REP-2011, "RIHS01_...". None if none is installed

    @property
    def package(self) -> str:
        """The package of the type."""
        return self.name.split("/")[0]

    @property
    def short_name(self) -> str:
        """The name without package."""
        return self.name.rsplit("/", 1)[1]

    @property
    def title(self) -> str:
        """The name in error texts: the full name, or ``the pkg/srv/Name request``."""
        # no message has an underscore in its name
        interface, underscore, part = self.short_name.partition("_")
        if not underscore:
            return self.name
        return f"the {self.name.rsplit('/', 1)[0]}/{interface} {part.lower()}"

    @property
    def is_keyed(self) -> bool:
        """True if a field is a key. Those of nested messages do not count."""
        return any(field.is_key for field in self.fields)

    def nested(self) -> tuple[str, ...]:
        """The message types that the fields use directly, each once, in order."""
        return tuple(dict.fromkeys(f.type.base for f in self.fields if not f.type.is_primitive))
