# SPDX-License-Identifier: Apache-2.0
"""CBOR in (RFC 8949), from clients that may send anything: what JSON can say, and octets.

Written for what it refuses. To a reader that knows all of CBOR, a frame of a kilobyte can state
arrays of 2**64 elements, share parts, nest forever, or be a regular expression. Here each item
costs about as much as it has bytes, and all of them are counted.
"""

from collections.abc import Mapping
from struct import Struct
from struct import error as StructError  # noqa: N812
from typing import Any, ClassVar, Final

import numpy as np
from typing_extensions import Never

from gateway.codec.cbor import MAP, OCTETS, TYPED_ARRAYS
from gateway.codec.error_text import CodecError
from gateway.codec.json import MAX_DEPTH
from gateway.codec.json_bounds import MAX_COST, MAX_ITEMS, WIDE_COST
from schemas.json_forms import NumberArray

# Outside of typed arrays, keys included: 10 to 15 ms for so many.
MAX_SINGLE_ITEMS: Final = 15_000
# As Python's numbers they take long, and much memory. Small arrays are encoded faster from them.
MAX_LISTED: Final = 10_000

_TAG: Final = 0xC0
_TAG_ITEMS: Final = 3  # a typed array takes as long as so many items, without its tag and its bytes
_MIN_INTEGER: Final = -(2**63)
_OCTET_TAGS: Final = frozenset({64, 68})  # RFC 8746: uint8, and uint8 that was clamped
_SIMPLE_MAJOR: Final = 7
_ONE_BYTE: Final = 24  # the argument itself, if it is below
_ARGUMENTS: Final = {24: Struct(">B"), 25: Struct(">H"), 26: Struct(">I"), 27: Struct(">Q")}
_FLOATS: Final = {25: Struct(">e"), 26: Struct(">f"), 27: Struct(">d")}
_SIMPLE: Final[Mapping[int, bool | None]] = {20: False, 21: True, 22: None, 23: None}
_DTYPES: Final = {head[1]: np.dtype(name).newbyteorder("<") for name, head in TYPED_ARRAYS.items()}


class CborError(CodecError):
    """A client sent something else than the CBOR it may send. The text says where and why."""


def is_cbor(data: bytes) -> bool:
    """Return whether a message is a map in CBOR, by its first byte, with which no UTF-8 begins."""
    return bool(data) and MAP <= data[0] < _TAG


def loads(data: bytes, *, max_depth: int = MAX_DEPTH, max_items: int = MAX_ITEMS) -> object:
    """Read one item, in the values that `gateway.codec.json.loads` returns, and bytes.

    Typed arrays of RFC 8746 become lists of numbers, or a `NumberArray` when these have
    `MAX_LISTED` in all. Those of uint8 become bytes, ``undefined`` becomes ``None``. *max_depth*
    bounds how deep arrays and maps nest, *max_items* and `MAX_SINGLE_ITEMS` how many items there
    are outside of typed arrays. It costs no more than `MAX_COST`, as text that is not ASCII does.

    Raises:
        CborError: it is not CBOR, it is CBOR that JSON has nothing for, a limit is exceeded, or a
            map has a key twice.
    """
    reader = _Reader(data, max_depth, max_items)
    value = reader.item()
    reader.expect_end()
    return value


class _Reader:
    def __init__(self, data: bytes, max_depth: int, max_items: int) -> None:
        self._data = data
        self._at = 0
        self._start = 0  # of the item at hand
        self._depth = 0
        self._max_depth = max_depth
        self._max_items = max_items
        self._max_singles = min(max_items, MAX_SINGLE_ITEMS)
        self._instead = "send numbers as typed arrays (RFC 8746)"
        if max_items < MAX_SINGLE_ITEMS:
            self._instead += ", or raise limits.max_json_items"
        self._singles = 0
        self._numbers = 0  # in typed arrays
        self._cost = len(data)

    def item(self) -> object:
        self._singles += 1
        if self._singles > self._max_singles:
            limit = f"over {self._max_singles} items; {self._instead}"
            raise CborError(f"frame has {limit}")
        self._start = self._at
        try:
            initial = self._data[self._at]
        except IndexError:
            self._refuse("it ends where an item is missing")
        self._at += 1
        major, info = initial >> 5, initial & 0x1F
        if major == _SIMPLE_MAJOR:
            return self._simple(info)
        return self._READERS[major](self, info if info < _ONE_BYTE else self._argument(info))

    def expect_end(self) -> None:
        if self._at != len(self._data):
            self._start = self._at
            self._refuse("it goes on behind its end")

    # One method for each major type, given its argument: a value, a length or a tag

    def _unsigned(self, value: int) -> int:
        return value

    def _negative(self, value: int) -> int:
        if ~value < _MIN_INTEGER:
            self._refuse("an integer below -2**63")
        return ~value

    def _octets(self, length: int) -> bytes:
        octets = self._data[self._at : self._at + length]
        if len(octets) != length:
            self._refuse(f"it ends within a string of {length} bytes")
        self._at += length
        return octets

    def _text(self, length: int) -> str:
        octets = self._octets(length)
        if not octets.isascii():
            self._cost += WIDE_COST * length
            if self._cost > MAX_COST:
                reason = "takes too long to read, for its text that is not ASCII"
                raise CborError(f"frame of {len(self._data)} bytes {reason}")
        try:
            return octets.decode()
        except UnicodeDecodeError:
            self._refuse("text that is not UTF-8")

    def _array(self, length: int) -> list[object]:
        self._enter()
        items = [self.item() for _ in range(length)]
        self._depth -= 1
        return items

    def _map(self, length: int) -> dict[str, object]:
        self._enter()
        members: dict[str, object] = {}
        for _ in range(length):
            name = self.item()
            if type(name) is not str:
                self._refuse("a key that is not text")
            if name in members:
                self._refuse("a key twice in one map")
            members[name] = self.item()
        self._depth -= 1
        return members

    def _tagged(self, tag: int) -> object:
        dtype = _DTYPES.get(tag)
        if dtype is None and tag not in _OCTET_TAGS:
            self._refuse(f"tag {tag}, known are those of typed arrays, little-endian")
        following = self._data[self._at : self._at + 1]
        if not following or following[0] >> 5 != OCTETS >> 5:  # nor another tag: they may nest
            self._refuse("a typed array that is not a byte string")
        self._singles += _TAG_ITEMS
        octets = self.item()
        assert isinstance(octets, bytes)  # noqa: S101  # as its head says
        return octets if dtype is None else self._numbers_of(octets, dtype)

    # by number, RFC 8949, 3.1
    _READERS: ClassVar = (_unsigned, _negative, _octets, _text, _array, _map, _tagged)

    # Parts of these

    def _simple(self, info: int) -> float | bool | None:
        if info in _SIMPLE:
            return _SIMPLE[info]
        struct = _FLOATS.get(info)
        if struct is None:
            self._refuse("a simple value other than false, true, null and undefined")
        return float(self._unpack(struct))

    def _argument(self, info: int) -> int:
        struct = _ARGUMENTS.get(info)
        if struct is None:
            self._refuse("an item of indefinite length, or of a reserved kind")
        return int(self._unpack(struct))

    def _unpack(self, struct: Struct) -> Any:
        try:
            (value,) = struct.unpack_from(self._data, self._at)
        except StructError:
            self._refuse("it ends within a number")
        self._at += struct.size
        return value

    def _numbers_of(self, octets: bytes, dtype: np.dtype[Any]) -> Any:
        if len(octets) % dtype.itemsize:
            self._refuse(f"a typed array of {len(octets)} bytes for numbers of {dtype.itemsize}")
        numbers = np.frombuffer(octets, dtype)
        self._numbers += len(numbers)
        return NumberArray(numbers) if self._numbers > MAX_LISTED else numbers.tolist()

    def _enter(self) -> None:
        self._depth += 1
        if self._depth > self._max_depth:
            raise CborError(
                f"frame nests deeper than {self._max_depth} levels; raise limits.max_json_depth"
            )

    def _refuse(self, reason: str) -> Never:
        raise CborError(f"frame is not CBOR that can be taken: {reason}, at byte {self._start}")
