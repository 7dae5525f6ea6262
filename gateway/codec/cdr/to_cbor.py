# SPDX-License-Identifier: Apache-2.0
"""CDR to CBOR without Python objects where both agree: arrays are slices of the CDR."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from struct import Struct
from typing import Final, TypeAlias

import numpy as np

from gateway.codec import cbor
from gateway.codec.cdr.layout import CODES, ByteOrder, Numbers
from gateway.codec.cdr.sliced_elements import CborElements
from gateway.codec.cdr.source import SourceCode
from gateway.codec.cdr.target import Target
from schemas.definition import (
    FLOATS,
    INTEGER_RANGES,
    OCTETS,
    PRIMITIVES,
    STRINGS,
    FieldType,
)

# Any octet but 0 is true.
_BOOLEANS: Final = bytes((cbor.FALSE, *[cbor.TRUE] * 255))

_NUMBERS: Final = PRIMITIVES - STRINGS


@dataclass(frozen=True, slots=True)
class SourcePart:
    """A part of the item: a constant, a number of fixed size, or source that makes bytes."""

    content: bytes | str
    code: str = ""  # of struct, for a number

    @property
    def is_fixed(self) -> bool:
        """True if its size is known."""
        return isinstance(self.content, bytes) or bool(self.code)


SourceParts: TypeAlias = tuple[SourcePart, ...]


class Cbor(Target[SourceParts]):
    """Makes one CBOR item.

    Numbers have the width of their type, whatever their value (RFC 8949, 4.1 prefers the
    shortest, but does not require it). So one `struct.Struct` writes neighbours together with
    the names between them.
    """

    # every float is a float64, and 0.1f one of 0.10000000149011612
    names: Mapping[str, object] = {
        "BOOLEANS": _BOOLEANS,
        "frombuffer": np.frombuffer,
        "head": cbor.head,
        "text": cbor.text,
    }

    def octets(self, octets: str) -> str:
        """Keep the bytes, or the view."""
        return octets

    def numbers(self, member: Numbers, order: ByteOrder, source: SourceCode) -> str:
        """Make little-endian bytes, a slice of the CDR if that is little-endian."""
        if member.base == "bool":
            return "bytes(data[offset:end]).translate(BOOLEANS)"
        if order == ">" and member.size > 1:
            wire = np.dtype(f">{CODES[member.base]}")
            dtype = source.constant(member.base.upper(), wire, wire.str)
            little = f"<{CODES[member.base]}"
            return f'frombuffer(data, {dtype}, count, offset).astype("{little}").tobytes()'
        # a view costs as much as a copy of some hundred bytes
        return "data[offset:end]" if member.length is not None else "memoryview(data)[offset:end]"

    def value(self, kind: FieldType, name: str) -> SourceParts:
        """Make the item of one field."""
        if not kind.is_array:
            return _text(name) if kind.base in STRINGS else _number(kind.base, name)
        if kind.base in OCTETS:
            return _counted(cbor.OCTETS, kind, name)
        if kind.base in FLOATS or kind.base in INTEGER_RANGES:
            size = np.dtype(CODES[kind.base]).itemsize
            tag = SourcePart(cbor.TYPED_ARRAYS[kind.base])
            return (tag, *_counted(cbor.OCTETS, kind, name, size))
        if kind.base == "bool":
            return _counted(cbor.ARRAY, kind, name)
        count = SourcePart(f"head({cbor.ARRAY}, len({name}))")
        return (count, SourcePart(f'b"".join({name})'))

    def message(self, members: Sequence[tuple[str, SourceParts]]) -> SourceParts:
        """Make a map."""
        pieces = [SourcePart(cbor.head(cbor.MAP, len(members)))]
        for name, value in members:
            pieces += (SourcePart(cbor.text(name)), *value)
        return tuple(pieces)

    def expression(self, value: SourceParts, source: SourceCode) -> str:
        """Join the pieces, neighbours of fixed size in one."""
        parts = _parts(value, source)
        return parts[0] if len(parts) == 1 else f'b"".join(({", ".join(parts)}))'


class SlicedCbor(Cbor):
    """Makes one CBOR item in slices, and leaves the pieces of the message apart."""

    pauses = True
    elements = "CborElements()"
    names: Mapping[str, object] = {
        **Cbor.names,
        "CborElements": CborElements,
    }

    def value(self, kind: FieldType, name: str) -> SourceParts:
        """Make the item of one field. One of many elements stays in pieces."""
        if kind.is_array and kind.base not in _NUMBERS:
            return (SourcePart(f"head({cbor.ARRAY}, {name}.count)"), SourcePart(f"*{name}.parts"))
        return super().value(kind, name)

    def result(self, value: SourceParts, source: SourceCode) -> str:
        """Return a tuple: neighbours of fixed size are one piece, each array is one."""
        return f"({', '.join(_parts(value, source))},)"


def _parts(pieces: SourceParts, source: SourceCode) -> list[str]:
    parts = []
    for is_fixed, group in groupby(pieces, key=lambda piece: piece.is_fixed):
        if is_fixed:
            parts.append(_packed(group, source))
        else:
            parts += [str(piece.content) for piece in group]
    return parts


def _text(name: str) -> SourceParts:
    return (SourcePart(f"text({name})"),)


def _number(base: str, name: str) -> SourceParts:
    if base in FLOATS:
        return (SourcePart(cbor.FLOAT64), SourcePart(name, "d"))
    if base == "bool":
        return (SourcePart(f"{cbor.FALSE} + {name}", "B"),)
    code = CODES[base]
    width = {"b": 24, "h": 25, "i": 26, "q": 27}[code.lower()]
    if code.isupper():
        return (SourcePart(bytes((cbor.UNSIGNED | width,))), SourcePart(name, code))
    # a negative number is written as its complement. >> 63 is 0 or -1
    kind = SourcePart(f"{width} | {name} >> 63 & {cbor.NEGATIVE}", "B")
    return (kind, SourcePart(f"{name} ^ {name} >> 63", code.upper()))


def _counted(major: int, kind: FieldType, name: str, size: int = 1) -> SourceParts:
    if kind.length is not None:
        return (SourcePart(cbor.head(major, kind.length * size)), SourcePart(name))
    return (SourcePart(f"head({major}, len({name}))"), SourcePart(name))


def _packed(pieces: Iterable[SourcePart], source: SourceCode) -> str:
    """Write pieces of fixed size at once, adjacent constants as one."""
    form = ">"
    values: list[str] = []
    for is_number, group in groupby(pieces, key=lambda piece: bool(piece.code)):
        if is_number:
            numbers = list(group)
            form += "".join(piece.code for piece in numbers)
            values += [str(piece.content) for piece in numbers]
        else:
            constant = b"".join(bytes(piece.content) for piece in group)  # type: ignore[arg-type]
            form += f"{len(constant)}s"
            values.append(source.constant("KEYS", constant, repr(constant)))
    if len(values) == 1 and form.endswith("s"):
        return values[0]
    struct = Struct(form)
    return f"{source.constant('PACK', struct.pack, struct.format)}({', '.join(values)})"
