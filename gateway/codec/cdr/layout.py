# SPDX-License-Identifier: Apache-2.0
"""The layout of a message in CDR: its members, flattened, in wire order."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from struct import Struct, calcsize
from typing import Final, Literal, TypeAlias

from gateway.codec.error_text import FieldError
from schemas.definition import OCTETS, STRINGS, Definition, Field, Value
from schemas.installed import InstalledDefinitions

# The selected fields by name, each with the selection within it. None selects everything.
Selection: TypeAlias = "dict[str, Selection] | None"


def select(
    definition: Definition, definitions: InstalledDefinitions, fields: Iterable[str]
) -> Selection:
    """Turn dotted paths such as ``pose.pose.position`` into a tree. No path means everything.

    A path through an array of messages applies to each of its elements.

    Raises:
        FieldError: a path names no field.
    """
    tree: dict[str, Selection] = {}
    for path in fields:
        _add(tree, definition, definitions, path)
    return tree or None


def _add(
    tree: dict[str, Selection], definition: Definition, definitions: InstalledDefinitions, path: str
) -> None:
    *parents, last = path.split(".")
    for depth, name in enumerate(parents, start=1):
        field = _field(definition, name, path)
        if field.type.is_primitive:
            reached = ".".join(parents[:depth])
            raise FieldError(f"unknown field {path}: {reached} is {field.type}, it has no fields")
        definition = definitions.get(field.type.base)
        below = tree.setdefault(name, {})
        if below is None:  # an earlier path selects all of it, but this one must also exist
            below = {}
        tree = below
    _field(definition, last, path)
    tree[last] = None


def _field(definition: Definition, name: str, path: str) -> Field:
    for field in definition.fields:
        if field.name == name:
            return field
    names = ", ".join(field.name for field in definition.fields) or "no fields"
    raise FieldError(f"unknown field {path}: {definition.title} has {names}")


HEADER_BYTES: Final = 4  # the encapsulation header. Offsets count from its start
ALIGNMENTS: Final = 8  # no primitive is aligned to more than 8 bytes
# From about this many on, a numpy view and its JSON take less time than as many Python
# numbers (measured: 20 to 24 for each of the types).
NUMPY_LENGTH: Final = 24

ByteOrder = Literal["<", ">"]
Cdr: TypeAlias = bytes | memoryview
"""A message with its encapsulation header, as octets."""

Path: TypeAlias = tuple[str, ...]

CODES: Final = {
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


@dataclass(frozen=True, slots=True)
class Fixed:
    """A primitive or a short fixed array of them. Its size is known, so neighbours share a run."""

    path: Path
    base: str
    length: int | None
    wanted: bool
    default: Value | None = None

    @property
    def is_octets(self) -> bool:
        """True for an array of raw bytes."""
        return self.length is not None and self.base in OCTETS


@dataclass(frozen=True, slots=True)
class Text:
    """A string: uint32 count, then UTF-8 with a NUL, or (wide) UTF-16 units of 4 bytes each."""

    path: Path
    is_wide: bool
    bound: int | None
    wanted: bool
    default: Value | None = None


@dataclass(frozen=True, slots=True)
class Numbers:
    """A sequence of primitives: uint32 count, then the elements, or a long fixed array."""

    path: Path
    base: str
    length: int | None
    bound: int | None
    wanted: bool
    default: Value | None = None

    @property
    def size(self) -> int:
        """The size of one element in bytes."""
        return calcsize(f"<{CODES[self.base]}")

    @property
    def is_octets(self) -> bool:
        """True for an array of raw bytes."""
        return self.base in OCTETS


@dataclass(frozen=True, slots=True)
class Elements:
    """An array of strings or messages: uint32 count unless fixed, then each element."""

    path: Path
    members: tuple["Member", ...]  # of one element. Their paths begin with the array's own
    definition: Definition | None  # of an element. None if it is a string
    selection: Selection  # of an element
    length: int | None
    bound: int | None
    wanted: bool
    default: Value | None = None


Member: TypeAlias = Fixed | Text | Numbers | Elements


def flatten(
    definition: Definition, definitions: InstalledDefinitions, selection: Selection = None
) -> tuple[Member, ...]:
    """Return the members of a message in wire order, up to the last selected one."""
    members = list(_members(definition, definitions, (), selection, wanted=True))
    while members and not members[-1].wanted and selection is not None:
        members.pop()
    return tuple(members)


def item_path(path: Path) -> Path:
    """Return the path of one element of an array. No field has such a name."""
    return (*path, "0")


def least_size(members: Sequence[Member]) -> int:
    """Return the smallest number of bytes of the members: empty sequences, no padding."""
    total = 0
    for member in members:
        match member:
            case Fixed():
                total += calcsize(f"<{member.length or 1}{CODES[member.base]}")
            case Numbers(length=int() as length):
                total += length * member.size
            case Elements(length=int() as length):
                total += length * least_size(member.members)
            case _:
                total += 4
    return total


def _members(
    definition: Definition,
    definitions: InstalledDefinitions,
    parent: Path,
    selection: Selection,
    *,
    wanted: bool,
) -> Iterator[Member]:
    if not definition.fields:
        # IDL has no empty struct: rosidl adds one uint8 that nobody reads
        yield Fixed(parent, "uint8", None, wanted=False)
    for field in definition.fields:
        is_wanted = wanted and (selection is None or field.name in selection)
        below = selection[field.name] if selection and is_wanted else None
        yield from _of_field(field, definitions, (*parent, field.name), below, is_wanted)


def _of_field(
    field: Field, definitions: InstalledDefinitions, path: Path, selection: Selection, wanted: bool
) -> Iterator[Member]:
    kind = field.type
    if kind.base in STRINGS:
        text = Text(path, kind.base == "wstring", kind.string_bound, wanted)
        if kind.is_array:
            item = replace(text, path=item_path(path))
            yield Elements(
                path, (item,), None, None, kind.length, kind.bound, wanted, field.default
            )
        else:
            yield replace(text, default=field.default)
    elif kind.is_primitive:
        if kind.is_sequence or (kind.length or 0) > NUMPY_LENGTH:
            yield Numbers(path, kind.base, kind.length, kind.bound, wanted, field.default)
        else:
            yield Fixed(path, kind.base, kind.length, wanted, field.default)
    else:
        definition = definitions.get(kind.base)
        members = _members(definition, definitions, path, selection, wanted=wanted)
        if kind.is_array:
            parts = tuple(members)
            yield Elements(path, parts, definition, selection, kind.length, kind.bound, wanted)
        else:
            yield from members


@dataclass(frozen=True, slots=True)
class Slot:
    """A part of a run, with a struct code and its count: values, their bytes, or padding."""

    code: str
    count: int = 1
    is_padding: bool = False
    is_raw: bool = False


class Run:
    """Neighbours of fixed size, read or written by one `struct.Struct`.

    The padding depends on the offset of the run, so there are up to eight structs, one for each
    residue of the offset modulo 8.
    """

    def __init__(self, slots: Sequence[Slot], order: ByteOrder) -> None:
        self.slots = tuple(slots)
        self._order = order

    @property
    def alignment(self) -> int:
        """The largest alignment in the run."""
        return max(calcsize(f"<{slot.code}") for slot in self.slots)

    def at(self, residue: int) -> Struct:
        """Return the struct for an offset, counted from the header's start, modulo 8."""
        parts: list[str] = [self._order]
        position = residue
        for slot in self.slots:
            size = calcsize(f"<{slot.code}")
            padding = (HEADER_BYTES - position) % size
            parts.append("x" * padding)
            length = size * slot.count
            if slot.is_padding:
                parts.append(f"{length}x")
            elif slot.is_raw:
                parts.append(f"{length}s")
            else:
                parts.append(slot.code if slot.count == 1 else f"{slot.count}{slot.code}")
            position += padding + length
        return Struct("".join(parts))

    def starts(self, residue: int) -> Iterator[int]:
        """Yield the position of each slot in the struct for this residue."""
        position = residue
        for slot in self.slots:
            size = calcsize(f"<{slot.code}")
            position += (HEADER_BYTES - position) % size
            yield position - residue
            position += size * slot.count

    def at_all(self) -> list[Struct]:
        """Return the structs for all residues, by residue."""
        return [self.at(residue) for residue in range(ALIGNMENTS)]

    def residue_after(self, residue: int | None) -> int | None:
        """Return the residue behind the run. None if it depends on where the run begins."""
        starts = range(ALIGNMENTS) if residue is None else [residue]
        ends = {(start + self.at(start).size) % ALIGNMENTS for start in starts}
        return ends.pop() if len(ends) == 1 else None
