# SPDX-License-Identifier: Apache-2.0
"""The forms in which JSON may hold octets, times and headers, in addition to the plain one.

Functions that turn them into the plain form. A value that has no such form comes back unchanged,
for its reader to refuse.
"""

import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any, Final, TypeAlias

import numpy as np
import numpy.typing as npt
import pybase64

Clock: TypeAlias = int | Callable[[], int]
"""ROS time in nanoseconds, or a function that returns it."""

# Characters of base64 with line breaks, as MIME and Android make it. Taking them out costs fifteen
# times as much as decoding: 3 ms for this many.
MAX_BROKEN_TEXT: Final = 4 * 1024**2
_WHITESPACE: Final = b" \t\r\n"

NON_FINITE: Final[Mapping[object, float]] = {
    None: math.nan,
    "NaN": math.nan,
    "Infinity": math.inf,
    "-Infinity": -math.inf,
}
"""The forms of floats that JSON has no numbers for."""

# Up to here every integer is a float. Beyond, one float stands for several.
MAX_WHOLE: Final = 2**53

_NO_OCTET: Final = "item {} is not an integer from 0 to 255"
_ROS1_NAMES: Final = {"secs": "sec", "nsecs": "nanosec"}


class NumberArray:
    """A long array of numbers, as an array of numpy.

    It is not one itself, because numpy compares each number, and has no truth value then.
    """

    __slots__ = ("values",)
    __hash__ = None  # type: ignore[assignment]  # as that of a list

    def __init__(self, values: npt.NDArray[Any]) -> None:
        self.values = values


class OctetsError(ValueError):
    """A value holds no octets. The text is for the client that sent it."""


class _ItemError(OctetsError):
    """One of the items is not an octet. The text finds it when it is read."""

    def __init__(self, items: list[object]) -> None:
        self._items = items

    def __str__(self) -> str:
        return _NO_OCTET.format(_first_misfit(self._items))


def whole(value: Any) -> Any:
    """Return the integer that a float without a fraction is, up to `MAX_WHOLE`."""
    if type(value) is float and value.is_integer() and -MAX_WHOLE <= value <= MAX_WHOLE:
        return int(value)
    return value


def wholes(values: list[Any]) -> list[Any]:
    """Return an array of integers and floats with `whole` done to each."""
    numbers = np.array(values, np.float64)
    is_whole = _is_whole(numbers)
    # an integer beyond is rounded to MAX_WHOLE at least
    if is_whole.all() and (np.abs(numbers) < MAX_WHOLE).all():
        exact: list[int] = numbers.astype(np.int64).tolist()
        return exact
    if _first_float(values, ~is_whole) is not None:
        return values
    return list(map(int, values))


def first_fraction(values: list[Any]) -> int | None:
    """Return the index of the first float that may not be an integer, if there is one.

    Among 100,000 numbers of a client numpy finds it in the time of 20,000 tests.
    """
    return _first_float(values, ~_is_whole(np.array(values, np.float64)))


def _is_whole(numbers: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
    is_whole: npt.NDArray[np.bool_] = np.trunc(numbers) == numbers
    return is_whole & (np.abs(numbers) <= MAX_WHOLE)


def _first_float(values: list[Any], is_doubtful: npt.NDArray[np.bool_]) -> int | None:
    doubtful = np.flatnonzero(is_doubtful)
    if doubtful.size and type(values[doubtful[0]]) is float:  # then the others need not be listed
        return int(doubtful[0])
    return next((index for index in doubtful.tolist() if type(values[index]) is float), None)


def octets(value: object) -> bytes:
    """Return the bytes of base64 text, of an array of integers, or of bytes.

    Raises:
        OctetsError: the value has another form.
    """
    match value:
        case str():
            return _octets_of_text(value)
        case list():
            return _octets_of_list(value)
        case bytes() | bytearray() | memoryview():
            return bytes(value)
        case NumberArray():
            return _octets_of_array(value.values)
    raise OctetsError("expected base64 text or an array of integers")


def duration(value: object, _now_ns: Clock = 0) -> object:
    """Return a Duration with the names of ROS 2, given those of either ROS."""
    if type(value) is not dict or not ("secs" in value or "nsecs" in value):
        return value
    # If both names are given, the old one stays and is refused as unknown.
    return {
        key if _ROS1_NAMES.get(key, key) in value else _ROS1_NAMES.get(key, key): item
        for key, item in value.items()
    }


def time(value: object, now_ns: Clock) -> object:
    """Return a Time with the names of ROS 2, given those of either ROS or ``"now"``."""
    if value != "now":
        return duration(value)
    sec, nanosec = divmod(now_ns if isinstance(now_ns, int) else now_ns(), 10**9)
    return {"sec": sec, "nanosec": nanosec}


def header(value: object, now_ns: Clock | None) -> object:
    """Return a Header without the ``seq`` of ROS 1.

    One without a ``stamp``, or with an empty one, is stamped now, as in rosbridge, if there is a
    clock.
    """
    if type(value) is not dict:
        return value
    stamp = value.get("stamp")
    if stamp and "seq" not in value:
        return value
    fields = {key: item for key, item in value.items() if key != "seq"}
    if now_ns is not None and ("stamp" not in value or stamp == {}):
        fields["stamp"] = "now"
    return fields


FORMS: Final[Mapping[str, Callable[[object, Clock], object]]] = {
    "builtin_interfaces/msg/Duration": duration,
    "builtin_interfaces/msg/Time": time,
    "std_msgs/msg/Header": header,
}
"""The types that have special forms, by name."""


def _octets_of_text(text: str) -> bytes:
    try:
        return pybase64.b64decode(text, validate=True)
    except ValueError as error:
        if len(text) > MAX_BROKEN_TEXT or not text.isascii():
            raise OctetsError("text is not valid base64") from error
    try:
        return pybase64.b64decode(text.encode().translate(None, _WHITESPACE), validate=True)
    except ValueError as error:
        raise OctetsError("text is not valid base64") from error


def _octets_of_array(numbers: npt.NDArray[Any]) -> bytes:
    fit = (numbers >= 0) & (numbers <= 255) & (np.trunc(numbers) == numbers)
    if numbers.dtype.kind == "b" or not fit.all():
        raise OctetsError(_NO_OCTET.format(int(np.argmin(fit))))
    return numbers.astype(np.uint8).tobytes()


def _octets_of_list(items: list[object]) -> bytes:
    found = _as_octets(items)
    if found is None:
        raise _ItemError(items)
    return found


def _as_octets(items: list[object]) -> bytes | None:
    # bytes() would take True for 1. Checking the types as a set is five times as fast as checking
    # each item.
    types = set(map(type, items))
    with suppress(ValueError, TypeError):
        if types <= {int}:
            return bytes(items)  # type: ignore[arg-type]  # the line above saw integers only
        if types <= {int, float}:
            return _octets_of_numbers(items)
    return None


def _octets_of_numbers(items: list[Any]) -> bytes | None:
    numbers = np.array(items, np.float64)
    fit = (numbers >= 0) & (numbers <= 255) & (np.trunc(numbers) == numbers)
    return numbers.astype(np.uint8).tobytes() if fit.all() else None


def _first_misfit(items: list[object]) -> int:
    """Return the index of the first item that is not an octet.

    A client may send 100,000 with the last one wrong: halving looks at twice as many, but calls
    nothing for each.
    """
    start, end = 0, len(items)
    while end - start > 1:
        middle = (start + end) // 2
        if _as_octets(items[start:middle]) is None:
            end = middle
        else:
            start = middle
    return start
