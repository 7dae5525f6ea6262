# SPDX-License-Identifier: Apache-2.0
"""CBOR (RFC 8949) of the few kinds of values that frames have. Numbers in arrays as in RFC 8746.

The fast path is compiled per type (`gateway.codec.cdr.compile_transcoder`). This module encodes
the rest, and has the parts that both share.
"""

from struct import pack
from typing import Final

import numpy as np

# RFC 8949, 3.1: the major types, in the upper three bits of an item's first byte
UNSIGNED: Final = 0x00
NEGATIVE: Final = 0x20
OCTETS: Final = 0x40
TEXT: Final = 0x60
ARRAY: Final = 0x80
MAP: Final = 0xA0

FALSE: Final = 0xF4
TRUE: Final = 0xF5
FLOAT64: Final = b"\xfb"

# RFC 8746, 2.1: typed arrays, little-endian
TYPED_ARRAYS: Final = {
    "uint16": b"\xd8\x45",
    "uint32": b"\xd8\x46",
    "uint64": b"\xd8\x47",
    "int8": b"\xd8\x48",
    "int16": b"\xd8\x4d",
    "int32": b"\xd8\x4e",
    "int64": b"\xd8\x4f",
    "float32": b"\xd8\x55",
    "float64": b"\xd8\x56",
}


def head(major: int, value: int) -> bytes:
    """Return the head of an item: its major type, and a length or an integer below 2**64."""
    if value < 24:
        return bytes((major | value,))
    if value < 1 << 8:
        return bytes((major | 24, value))
    if value < 1 << 16:
        return pack(">BH", major | 25, value)
    if value < 1 << 32:
        return pack(">BI", major | 26, value)
    return pack(">BQ", major | 27, value)


def text(value: str) -> bytes:
    """Return a text string."""
    data = value.encode()
    return head(TEXT, len(data)) + data


def dumps(value: object) -> bytes:
    """Return the item for a value of the kinds that `gateway.codec.cdr.compile_decoder` returns.

    Bytes and views become byte strings. Lists of numbers do not become typed arrays.

    Raises:
        TypeError: the value is of another kind.
    """
    match value:
        case bool():
            return bytes((TRUE if value else FALSE,))
        case int():
            return head(UNSIGNED, value) if value >= 0 else head(NEGATIVE, ~value)
        case float():
            return FLOAT64 + pack(">d", value)
        case str():
            return text(value)
        case bytes() | memoryview():
            return b"".join((head(OCTETS, len(value)), value))
        case dict():
            members = (part for name, item in value.items() for part in (text(name), dumps(item)))
            return b"".join((head(MAP, len(value)), *members))
        case list() | tuple():
            return b"".join((head(ARRAY, len(value)), *map(dumps, value)))
    if isinstance(value, np.float32):  # as in a compiled message
        return FLOAT64 + pack(">d", value)
    raise TypeError(f"no CBOR for {type(value).__name__}")
