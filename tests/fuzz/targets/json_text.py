# SPDX-License-Identifier: Apache-2.0
"""JSON from a client: read as the standard says, or refused with words."""

import json
import math
from typing import Any

from gateway.codec.error_text import CodecError
from gateway.codec.json import LARGE_TEXT_BYTES, MAX_DEPTH, ascii_only, loads
from gateway.codec.json_bounds import MAX_CONTAINERS, MAX_ITEMS
from gateway.codec.nonfinite import writer
from tests.fuzz import seeds
from tests.fuzz.target import Target, check

write = writer("token")


class OtherwiseError(ValueError):
    """The gateway has more rules than the standard library."""


def run(data: bytes) -> None:
    try:
        value = loads(data)
    except CodecError as error:
        check(str(error), "refused without words")
        check(not is_plain(data), "refused", str(error))
        return
    # raises for what must be refused: two members of one name
    check(same(value, json.loads(data.decode(), object_pairs_hook=distinct)), "another value")
    text = write(value)
    check(same(value, loads(text)), "does not come back")
    escaped = ascii_only(text)
    check(escaped.isascii())
    check(same(value, loads(escaped)), "does not come back from ASCII")


def is_plain(data: bytes) -> bool:
    """Return whether the text is JSON beyond doubt, and far from every limit."""
    try:
        value = json.loads(data.decode(), object_pairs_hook=distinct, parse_float=finite)
        is_shallow = depth(value) <= MAX_DEPTH
        json.dumps(value, ensure_ascii=False).encode()  # lone surrogates
    except (ValueError, RecursionError):
        return False
    commas = data.count(b",") + data.count(b"[") + data.count(b"{")
    # the library accepts a byte order mark, which is not JSON
    is_short = len(data) <= LARGE_TEXT_BYTES  # with NaN and the like
    return (
        is_shallow
        and is_short
        and commas < min(MAX_ITEMS, MAX_CONTAINERS)
        and not data.startswith(b"\xef")
    )


def distinct(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        raise OtherwiseError
    return found


def finite(text: str) -> float:
    if not math.isfinite(float(text)):
        raise OtherwiseError
    return float(text)


def depth(value: Any) -> int:
    match value:
        case dict():
            return 1 + max(map(depth, value.values()), default=0)
        case list():
            return 1 + max(map(depth, value), default=0)
    return 0


def same(one: Any, other: Any) -> bool:
    """Compare values. Integers beyond 64 bits are floats for orjson."""
    match one, other:
        case dict(), dict():
            return one.keys() == other.keys() and all(same(one[key], other[key]) for key in one)
        case list(), list():
            return len(one) == len(other) and all(map(same, one, other))
        case float(), float() if math.isnan(one):
            return math.isnan(other)
        case float(), int() | float():
            return one == float(other) or math.isclose(one, other)
    return type(one) is type(other) and bool(one == other)


def corpus() -> list[bytes]:
    return [
        *seeds.frames(),
        b'{"a":1,"a":2}',
        b'{"a" :":","b":[1e9,-0.0,5e-324,18446744073709551615]}',
        b'["\\ud83e\\udd16","\\u0000","\xc3\xbc","\\"\\\\"]',
        b"[" * 40 + b"]" * 40,
        b'[NaN,Infinity,"\xff"]',
        b'{"NaN":[NaN, Infinity ,-Infinity],"\\"":"-Infinity"}',
    ]


TARGET = Target("JSON is read as the standard says, or refused with words", run, corpus)
