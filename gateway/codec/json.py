# SPDX-License-Identifier: Apache-2.0
"""JSON out, and JSON in from clients that may send anything.

Input goes through orjson, strict and fast, and then through a check that nothing was left out, so
that two readers of one frame never see two different messages.
"""

import codecs
import json
import re
from collections.abc import Callable, Generator, Iterable
from functools import partial
from typing import Any, Final, TypeVar

import orjson
import pybase64

from gateway.codec.error_text import MAX_ECHO, JsonError
from gateway.codec.json_arrays import read_arrays, with_arrays, without_arrays
from gateway.codec.json_bounds import MAX_CONTAINERS, MAX_ITEMS, Outline, count_names, outline
from gateway.codec.json_tokens import in_original, is_at_token, with_numbers, without_tokens
from schemas.json_forms import NumberArray

# Deeper than any ROS type nests, and far from the recursion limits of the code that follows.
MAX_DEPTH: Final = 32

LARGE_TEXT_BYTES: Final = 256 * 1024
"""A larger text takes too long to be read in Python, for the place of an error or of a NaN."""

# NaN, Infinity and, in a text with these, strings: 10 ms to put numbers in their places.
MAX_TOKENS: Final = 20_000

_PIECE_BYTES: Final = 64 * 1024  # decoded at once: the rest needs no memory

_CONTAINERS: Final = frozenset({dict, list})

_NOT_ASCII: Final = re.compile(r"[^\0-\x7f]+")


def _written(value: object) -> object:
    if isinstance(value, NumberArray):
        return value.values
    if isinstance(value, bytes | memoryview):
        return pybase64.b64encode_as_string(value)
    raise TypeError(f"no JSON for {type(value).__name__}")


# Bound rather than wrapped: it is called for every message.
dumps: Final[Callable[[object], bytes]] = partial(
    orjson.dumps, option=orjson.OPT_SERIALIZE_NUMPY, default=_written
)
"""Write values as UTF-8 JSON: numpy arrays as arrays, bytes as base64, NaN and infinities as null.

Views of bytes count as bytes. RFC 8259 has none of these, and orjson sends null for the last two.
"""


def ascii_only(text: bytes) -> bytes:
    """Return a JSON text with escapes for non-ASCII characters: beyond U+FFFF, surrogate pairs."""
    if text.isascii():
        return text
    return _NOT_ASCII.sub(lambda found: json.dumps(found[0])[1:-1], text.decode()).encode()


def loads(
    data: bytes | str,
    *,
    max_depth: int = MAX_DEPTH,
    max_items: int = MAX_ITEMS,
    takes_tokens: bool = True,
) -> object:
    """Read one JSON text.

    *max_depth* bounds how deep objects and arrays nest, *max_items* how many members and
    elements they have in all. `gateway.codec.json_bounds` has further bounds.

    In addition to RFC 8259, a text of up to `LARGE_TEXT_BYTES` may hold the values NaN, Infinity
    and -Infinity, at most `MAX_TOKENS`, if it *takes_tokens*.

    Raises:
        JsonError: the text is not JSON in UTF-8, a limit is exceeded, or an object has two members
            of one name.
    """
    if isinstance(data, str):
        data = data.encode("utf-8", "surrogatepass")  # orjson refuses it, with the position
    found = None
    if len(data) > min(max_items, MAX_CONTAINERS):  # each item takes a character at least
        found = in_one_go(outline(data, max_items, takes_arrays=False))
    return _loads(data, found, max_depth, takes_tokens=takes_tokens)


def loads_in_slices(
    data: bytes, *, max_depth: int = MAX_DEPTH, max_items: int = MAX_ITEMS
) -> Generator[None, None, object]:
    """Read one JSON text as `loads` does, with pauses in which others can have their turn.

    A long array that holds nothing but numbers, or booleans alone, becomes a `NumberArray` of any
    type that has all of them. Null and NaN are NaN there. These numbers are not counted as items.

    Raises:
        JsonError: as for `loads`.
    """
    found = yield from outline(data, max_items, takes_arrays=True)
    yield
    if not found.arrays:
        return _loads(data, found, max_depth, takes_tokens=True)
    arrays = yield from read_arrays(data, found.arrays)
    rest = without_arrays(data, found.arrays)
    yield
    return with_arrays(_loads(rest, found, max_depth, takes_tokens=True), arrays)


_Result = TypeVar("_Result")


def in_one_go(slices: Generator[None, None, _Result]) -> _Result:
    """Do without pauses what has them, and return its result."""
    while True:
        try:
            next(slices)
        except StopIteration as stop:
            result: _Result = stop.value
            return result


def _loads(data: bytes, found: Outline | None, max_depth: int, *, takes_tokens: bool) -> object:
    has_tokens = False
    try:
        value: object = orjson.loads(data)
    except orjson.JSONDecodeError as error:
        has_tokens = takes_tokens and is_at_token(error)
        if not has_tokens:
            raise _refusal(error, data, max_depth) from None
        value = _loads_tokens(error, data, max_depth)
    if not _has_names(data, found, _count_names(value, max_depth)):
        raise _duplicate(data)
    return with_numbers(value) if has_tokens else value


def _loads_tokens(refused: orjson.JSONDecodeError, data: bytes, max_depth: int) -> object:
    """Read a text that was *refused* at a NaN or Infinity, with integers in their places."""
    if len(data) > LARGE_TEXT_BYTES:  # else it takes too long
        limit = (
            f"at most {LARGE_TEXT_BYTES // 1024} KiB with NaN or Infinity; write them as strings"
        )
        raise JsonError(f"frame is not JSON: {limit}")
    if data.count(b"NaN") + data.count(b"Infinity") + data.count(b'"') // 2 > MAX_TOKENS:
        limit = f"at most {MAX_TOKENS} strings and NaN or Infinity; write these as strings"
        raise JsonError(f"frame is not JSON: {limit}")
    readable = without_tokens(data)
    if readable is None:
        raise _refusal(refused, data, max_depth)
    try:
        value: object = orjson.loads(readable)
    except orjson.JSONDecodeError as error:
        raise _refusal(in_original(error, data), data, max_depth) from None
    return value


def _refusal(error: json.JSONDecodeError, data: bytes, max_depth: int) -> JsonError:
    offset = invalid_at(data)
    if offset is not None:
        return JsonError(f"frame is not UTF-8 at offset {offset}", offset=offset)
    # orjson's own depth limit, or its allocation for a document that opens and never closes
    if "depth" in error.msg or "allocate" in error.msg:
        return _too_deep(max_depth)
    what = error.msg.partition(": ")[0]
    if what[1:2].islower():  # else it begins with an abbreviation
        what = what[:1].lower() + what[1:]
    return JsonError(
        f"frame is not JSON: {what} at line {error.lineno}, column {error.colno}",
        offset=error.pos if data.isascii() else len(error.doc[: error.pos].encode()),
    )


def _too_deep(max_depth: int) -> JsonError:
    return JsonError(f"JSON nests deeper than {max_depth} levels; raise limits.max_json_depth")


def _count_names(value: object, max_depth: int) -> int:
    """Count the members of all objects, level by level."""
    names = 0
    depth = 0
    level: list[Any] = [value] if type(value) in _CONTAINERS else []
    while level:
        depth += 1
        if depth > max_depth:
            raise _too_deep(max_depth)
        below: list[Any] = []
        for each in level:
            items: Iterable[Any] = each
            if type(each) is dict:
                names += len(each)
                items = each.values()
            for item in items:
                if type(item) in _CONTAINERS:
                    below.append(item)  # noqa: PERF401  # a comprehension is a call on Python 3.11
        level = below
    return names


def _has_names(data: bytes, found: Outline | None, count: int) -> bool:
    """Return whether a text has no more names than the *count* that parsing kept.

    Parsing keeps the last of two members of one name, so duplicates lower the count. A colon
    follows each name, but strings have colons, too ("publish:/cmd_vel:1"). If no white space
    precedes a colon, those behind names follow a quote.
    """
    if found is None:
        if data.count(b":") == count:
            return True
        has_space = b" :" in data or b"\n:" in data or b"\r:" in data or b"\t:" in data
        if not has_space and data.count(b'":') == count:
            return True
        return count_names(data) == count
    return found.colons == count


def _duplicate(data: bytes) -> JsonError:
    if len(data) <= LARGE_TEXT_BYTES:  # else reading it in Python takes too long
        try:
            # The depth has been checked. Numbers need not be read, and long ones would raise.
            json.loads(data, object_pairs_hook=_without_duplicates, parse_int=str, parse_float=str)
        except JsonError as error:
            return error
    return JsonError("an object has two members of one name")


def _without_duplicates(pairs: list[tuple[str, object]]) -> None:
    seen: set[str] = set()
    for name, _ in pairs:
        if name in seen:
            raise JsonError(f"duplicate key {json.dumps(name[:MAX_ECHO], ensure_ascii=False)}")
        seen.add(name)


def invalid_at(data: bytes) -> int | None:
    """Return the offset of the first octet that is not UTF-8 (RFC 3629), or ``None``."""
    if data.isascii():
        return None
    decoder = codecs.getincrementaldecoder("utf-8")()
    for start in range(0, len(data), _PIECE_BYTES):
        held, _ = decoder.getstate()  # of a character that the piece before has begun
        end = start + _PIECE_BYTES
        try:
            decoder.decode(data[start:end], final=end >= len(data))
        except UnicodeDecodeError as error:
            return start - len(held) + error.start
    return None
