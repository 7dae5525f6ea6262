# SPDX-License-Identifier: Apache-2.0
"""JSON of a large message, in slices, so that other work can be done between two of them.

The bytes are those of `gateway.codec.nonfinite.writer`, which writes a message at once. For 16 MB
of CDR, which are 46 MB of JSON, one call of orjson takes 0.1 to 0.4 s.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, Final

import numpy as np
import pybase64

# Numbers that are written at once: 20 us as int8, 0.2 ms as float64. Fewer, and the work around a
# slice shows.
SLICE_NUMBERS: Final = 8192
# Octets at once, a multiple of 3: base64 of one slice then ends without padding. 10 us.
SLICE_OCTETS: Final = 3 * 2**16

OCTETS_PER_NUMBER: Final = 16  # that are written in the time of one int8

Write = Callable[[object], bytes]
"""Writes a value as JSON."""


class WrittenArray:
    """An array that is JSON already."""

    def __init__(self) -> None:
        self.parts: list[bytes] = []


def json_slices(value: object, write: Write) -> Iterator[bytes]:
    """Yield the JSON of what a decoder with untouched octets returned, slice by slice.

    *write* is called with parts of the value.
    """
    match value:
        case dict():
            yield from _members(value, write)
        case list() | tuple():
            yield from element_slices(value, write, b"[")
            yield b"]" if value else b"[]"
        case np.ndarray():
            yield from _numbers(value, write)
        case memoryview() | bytes():
            yield from _octets(value)
        case WrittenArray():
            yield from value.parts
        case str() if len(value) > SLICE_NUMBERS:
            yield b'"'
            for start in range(0, len(value), SLICE_NUMBERS):
                yield write(value[start : start + SLICE_NUMBERS])[1:-1]
            yield b'"'
        case _:
            yield write(value)


def element_slices(values: Iterable[object], write: Write, opening: bytes) -> Iterator[bytes]:
    """Yield the JSON of elements, without the end of their array. No elements yield nothing.

    *opening* stands before the first one. As many are written at once as one slice has room for.
    """
    few: list[object] = []
    weight = 0
    for value in values:
        own = _weight(value)
        if few and weight + own > SLICE_NUMBERS:
            yield opening + _inner(few, write)
            opening, few, weight = b",", [], 0
        if own > SLICE_NUMBERS:
            yield opening
            yield from json_slices(value, write)
            opening = b","
        else:
            few.append(value)
            weight += own
    if few:
        yield opening + _inner(few, write)


def _members(values: Mapping[str, object], write: Write) -> Iterator[bytes]:
    opening = b"{"
    for name, value in values.items():
        yield opening + write(name) + b":"
        yield from json_slices(value, write)
        opening = b","
    yield b"}" if values else b"{}"


def _numbers(values: "np.ndarray[Any, Any]", write: Write) -> Iterator[bytes]:
    opening = b"["
    for start in range(0, len(values), SLICE_NUMBERS):
        yield opening + _inner(values[start : start + SLICE_NUMBERS], write)
        opening = b","
    yield b"]" if len(values) else b"[]"


def _octets(octets: memoryview | bytes) -> Iterator[bytes]:
    yield b'"'
    for start in range(0, len(octets), SLICE_OCTETS):
        yield pybase64.b64encode(octets[start : start + SLICE_OCTETS])
    yield b'"'


def _inner(values: object, write: Write) -> bytes:
    return write(values)[1:-1]


def _weight(value: object) -> int:
    """Return how many numbers take about as long to write. It ends beyond those of a slice."""
    match value:
        case np.ndarray():
            return len(value)
        case WrittenArray():
            return SLICE_NUMBERS + 1
        case str() | bytes() | memoryview():
            return 1 + len(value) // OCTETS_PER_NUMBER
        case dict():
            return _sum(value.values())
        case list() | tuple():
            return _sum(value)
    return 1


def _sum(values: Iterable[object]) -> int:
    weight = 1
    for value in values:
        weight += 1 + _weight(value)
        if weight > SLICE_NUMBERS:
            break
    return weight
