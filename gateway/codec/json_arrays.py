# SPDX-License-Identifier: Apache-2.0
"""Long arrays of numbers in a JSON text: maps, scans and clouds as most clients write them.

A number takes 40 bytes and more as a Python object, and long to read, so they are read a slice at a
time, into arrays of numpy. Integers stand for the arrays in the text that is left.
"""

import json
from collections.abc import Generator, Sequence
from typing import Any, Final

import numpy as np
import numpy.typing as npt
import orjson

from gateway.codec.error_text import JsonError
from gateway.codec.json_tokens import is_at_token
from schemas.json_forms import NumberArray

SLICE_BYTES: Final = 64 * 1024  # 2 ms for the shortest numbers

Array = npt.NDArray[Any]

# Of 19 digits and chosen at random, so that nobody writes them by accident: those of the arrays
# begin here. A text that has them itself is refused.
_FIRST_MARK: Final = 5203881634907120000
_SMALL: Final = [np.iinfo(dtype) for dtype in (np.int8, np.int16, np.int32)]
_LEAST: Final = np.iinfo(np.int64).min
_CONTAINERS: Final = frozenset({dict, list})


def read_arrays(
    data: bytes, places: Sequence[tuple[int, int]]
) -> Generator[None, None, list[Array]]:
    """Return the arrays whose elements begin and end at these places.

    Raises:
        JsonError: one of them is not JSON, or has numbers and booleans.
    """
    arrays: list[Array] = []
    for start, end in places:
        slices: list[Array] = []
        at = start
        while at <= end:  # behind a comma there is one more
            stop = end if end - at <= SLICE_BYTES else data.rfind(b",", at, at + SLICE_BYTES)
            if stop < 0:
                raise JsonError(f"frame is not JSON: a number of {SLICE_BYTES} bytes", offset=at)
            slices.append(_slice(data[at:stop], at))
            at = stop + 1
            yield
        array = np.empty(sum(map(len, slices)), _common_type(slices, start))
        at = 0
        while slices:  # which lets go of them: the array takes as much
            each = slices.pop(0)
            array[at : at + len(each)] = each
            at += len(each)
        arrays.append(array)
        yield
    return arrays


def without_arrays(data: bytes, places: Sequence[tuple[int, int]]) -> bytes:
    """Return the text with an integer for the elements of each array."""
    pieces: list[bytes] = []
    at = 0
    for number, (start, end) in enumerate(places, _FIRST_MARK):
        pieces += (data[at:start], b"%d" % number)
        at = end
    return b"".join((*pieces, data[at:]))


def with_arrays(value: object, arrays: Sequence[Array]) -> object:
    """Put the arrays into what was read from `without_arrays`, and return it."""
    marks = dict(enumerate(arrays, _FIRST_MARK))
    found = 0
    whole: list[Any] = [value]
    level: list[Any] = [whole]
    while level:
        below: list[Any] = []
        for each in level:
            for key, item in each.items() if type(each) is dict else enumerate(each):
                if _stands_alone(item) and item[0] in marks:
                    each[key] = NumberArray(marks[item[0]])
                    found += 1
                elif type(item) in _CONTAINERS:
                    below.append(item)
        level = below
    if found != len(arrays):
        raise JsonError("frame has an integer that stands for an array; leave it out")
    return whole[0]


def _stands_alone(item: Any) -> bool:
    """Return whether an item is an array of one integer."""
    return type(item) is list and len(item) == 1 and type(item[0]) is int


def _slice(text: bytes, offset: int) -> Array:
    """Read some elements, given where they begin."""
    try:
        values = _values(text)
    except json.JSONDecodeError as error:  # orjson's is one
        what = error.msg.partition(": ")[0]
        at = offset + max(error.pos - 1, 0)
        raise JsonError(f"frame is not JSON: {what} at offset {at}", offset=at) from None
    except ValueError:  # of an integer with thousands of digits
        raise JsonError(f"frame has too long a number behind {offset}", offset=offset) from None
    if not values:
        raise JsonError(f"frame is not JSON: no number at offset {offset}", offset=offset)
    if any(letter in text for letter in b".eEnNI"):
        if bool in (types := set(map(type, values))):
            if types != {bool}:
                raise _mixed(offset)
            return np.array(values, np.bool_)
        return np.array(values, np.float64)  # NaN for None
    try:
        numbers = np.array(values, np.int64)
    except OverflowError:  # those beyond 64 bits are floats already
        is_unsigned = set(map(type, values)) == {int} and min(values) >= 0
        return np.array(values, np.uint64 if is_unsigned else np.float64)
    if numbers.min() == _LEAST and float in set(map(type, values)):  # a little less than that
        return np.array(values, np.float64)
    return _smallest(numbers)


def _values(text: bytes) -> list[Any]:
    text = b"[%b]" % text
    try:
        values: list[Any] = orjson.loads(text)
    except orjson.JSONDecodeError as error:
        if not is_at_token(error):
            raise
        values = json.loads(text)  # which knows NaN and infinities, and is as strict for the rest
    return values


def _smallest(values: npt.NDArray[np.int64]) -> Array:
    low, high = values.min(), values.max()
    for info in _SMALL:
        if info.min <= low and high <= info.max:
            return values.astype(info.dtype)
    return values


def _common_type(slices: Sequence[Array], offset: int) -> np.dtype[Any]:
    """Return the type that has all numbers: integers are exact if there are no others."""
    types = {each.dtype for each in slices}
    kinds = {each.kind for each in types}
    if "b" in kinds and len(kinds) > 1:
        raise _mixed(offset)
    if kinds == {"i", "u"} and all(each.min() >= 0 for each in slices):
        return np.dtype(np.uint64)
    return np.result_type(*types)


def _mixed(offset: int) -> JsonError:
    return JsonError(f"an array has numbers and booleans, behind offset {offset}", offset=offset)
