# SPDX-License-Identifier: Apache-2.0
"""CDR of a message, moved to where it is aligned otherwise.

CDR aligns a primitive to its size, counted from the beginning of the whole message. A goal that
follows a goal's id of 16 bytes is as it is alone. A result that follows a status of one byte is
not. A structure is not aligned as a whole, so its definition has to be walked. This ends at the
first primitive that is aligned as strictly as any in it. From there on the distance is a multiple
of every alignment, and the rest is copied.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import repeat
from struct import Struct, calcsize
from typing import Final, TypeAlias

from gateway.sources.source import RosError
from schemas.definition import Definition, FieldType
from schemas.installed import InstalledDefinitions

# how `struct` writes a primitive. A byte as a number, as the definitions have it
CODES: Final = {
    "bool": "?",
    "byte": "B",
    "char": "B",
    "float32": "f",
    "float64": "d",
    "int8": "b",
    "int16": "h",
    "int32": "i",
    "int64": "q",
    "uint8": "B",
    "uint16": "H",
    "uint32": "I",
    "uint64": "Q",
}
_SIZES: Final = {base: calcsize(f"<{code}") for base, code in CODES.items()}
_COUNT_BYTES: Final = 4
# of a string: UTF-8 with its NUL counted, or UTF-16 units of 4 bytes each without one
_UNITS: Final = {"string": 1, "wstring": 4}


@dataclass(frozen=True, slots=True)
class _Numbers:
    """Primitives: so many, or as many as a count before them says."""

    size: int
    length: int | None


@dataclass(frozen=True, slots=True)
class _Text:
    """A string."""

    base: str


@dataclass(frozen=True, slots=True)
class _Elements:
    """Strings or structures: so many, or as many as a count before them says."""

    of_one: "_Layout"
    length: int | None


_Step: TypeAlias = _Numbers | _Text | _Elements


@dataclass(frozen=True, slots=True)
class _Layout:
    """The members of a structure, those of single structures within it among them."""

    steps: tuple[_Step, ...]
    alignment: int  # the strictest of them


class Realignment:
    """The layout of one type."""

    def __init__(self, definition: Definition, definitions: InstalledDefinitions) -> None:
        """Read it.

        Raises:
            UnknownTypeError, DefinitionError: a type that it nests is not known.
        """
        layouts: dict[str, _Layout] = {}
        for each in definitions.closure(definition.nested()):  # nested ones first
            layouts[each.name] = _layout(each, layouts)
        self._name = definition.name
        self._layout = _layout(definition, layouts)

    def move(self, source: bytes, start: int, before: bytes, *, is_little_endian: bool) -> bytes:
        """Return *before* and the message behind it, which is in *source* from *start* on.

        Both are without encapsulation header. Bytes behind the message may come as well.

        Raises:
            RosError: ``internal``: *source* ends within the message.
        """
        alignment = self._layout.alignment
        moving = _Moving(source, start, before, alignment, is_little_endian=is_little_endian)
        try:
            moving.walk(self._layout.steps)
        except EOFError as error:
            raise RosError("internal", f"{self._name}: {error}") from error
        return bytes(moving.target)


class _Moving:
    """A message on its way."""

    def __init__(
        self, source: bytes, start: int, before: bytes, alignment: int, *, is_little_endian: bool
    ) -> None:
        self.target = bytearray(before)
        self._source = source
        self._offset = start
        self._alignment = alignment
        self._count = Struct("<I" if is_little_endian else ">I")

    def walk(self, steps: Sequence[_Step]) -> bool:
        """Move members. Return whether all that is left has been copied."""
        for step in steps:
            if (self._offset - len(self.target)) % self._alignment == 0:
                self.target += self._source[self._offset :]
                return True
            match step:
                case _Numbers(size, None):
                    self._copy(self._read_count() * size, size)
                case _Numbers(size, int() as length):
                    self._copy(length * size, size)
                case _Text(base):
                    self._copy(self._read_count() * _UNITS[base], 1)
                case _Elements(of_one, length):  # each takes a byte at least, so the source ends it
                    count = self._read_count() if length is None else length
                    if any(self.walk(of_one.steps) for _ in repeat(None, count)):
                        return True
        return False

    def _read_count(self) -> int:
        self._copy(_COUNT_BYTES, _COUNT_BYTES)
        (count,) = self._count.unpack_from(self._source, self._offset - _COUNT_BYTES)
        return int(count)

    def _copy(self, length: int, alignment: int) -> None:
        if length == 0:  # Fast CDR aligns what there is
            return
        self._offset += -self._offset % alignment
        left = len(self._source) - self._offset
        if length > left:
            raise EOFError(f"need {length} bytes at offset {self._offset}, there are {left}")
        self.target += bytes(-len(self.target) % alignment)
        self.target += self._source[self._offset : self._offset + length]
        self._offset += length


def _layout(definition: Definition, layouts: Mapping[str, _Layout]) -> _Layout:
    if not definition.fields:  # rosidl adds one uint8, as IDL has no empty structure
        return _Layout((_Numbers(1, 1),), 1)
    parts = [_layout_of_field(field.type, layouts) for field in definition.fields]
    return _Layout(
        tuple(step for part in parts for step in part.steps), max(part.alignment for part in parts)
    )


def _layout_of_field(field: FieldType, layouts: Mapping[str, _Layout]) -> _Layout:
    size = _SIZES.get(field.base)
    count_alignment = _COUNT_BYTES if field.is_sequence else 1
    if size is not None:
        length = field.length if field.is_array else 1
        return _Layout((_Numbers(size, length),), max(size, count_alignment))
    one = layouts.get(field.base) or _Layout((_Text(field.base),), _COUNT_BYTES)
    if not field.is_array:
        return one
    return _Layout((_Elements(one, field.length),), max(one.alignment, count_alignment))
