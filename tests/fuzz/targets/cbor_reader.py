# SPDX-License-Identifier: Apache-2.0
"""CBOR from a client: read as another reader does, or refused with words."""

import json
import struct
from typing import Any

import cbor2

from gateway.codec import cbor
from gateway.codec.cbor_reader import MAX_SINGLE_ITEMS, loads
from gateway.codec.error_text import CodecError
from gateway.codec.json import MAX_DEPTH
from tests.fuzz import seeds
from tests.fuzz.target import Target, check

# RFC 8746, 2.1, little-endian, by tag, in the names of struct
TYPED = {69: "H", 70: "I", 71: "Q", 72: "b", 77: "h", 78: "i", 79: "q", 85: "f", 86: "d"}


def run(data: bytes) -> None:
    try:
        value = loads(data)
    except CodecError as error:
        check(str(error).startswith("frame "), "refused without words")
        check(not is_plain(data), "refused", str(error))
        return
    check(repr(value) == repr(plain(cbor2.loads(data))), "another value")
    if data.count(b"\xf7") + data.count(b"\xf6") == 0:  # null is nothing that the gateway sends
        check(repr(loads(cbor.dumps(value))) == repr(value), "does not come back")


def plain(value: Any) -> Any:
    """Return what cbor2 has read with typed arrays, which are tags to it, and without undefined."""
    match value:
        case dict():
            return {name: plain(item) for name, item in value.items()}
        case list():
            return list(map(plain, value))
        case cbor2.CBORTag(tag=tag, value=octets) if tag in (64, 68):
            return octets
        case cbor2.CBORTag(tag=tag, value=octets):
            code = TYPED[tag]
            return list(struct.unpack(f"<{len(octets) // struct.calcsize(code)}{code}", octets))
    return None if value is cbor2.undefined else value


def is_plain(data: bytes) -> bool:
    """Return whether it is what cbor2 writes for values of JSON, far from every limit."""
    try:
        value = cbor2.loads(data)
        text = json.dumps(value)
        is_same = cbor2.dumps(json.loads(text)) == data
    except (ValueError, TypeError, RecursionError, cbor2.CBORDecodeError, OverflowError):
        return False
    is_shallow = text.count("[") + text.count("{") <= MAX_DEPTH
    has_big = any(data.find(tag) >= 0 for tag in (b"\xc2", b"\xc3", b"\x3b"))  # integers
    return is_same and is_shallow and not has_big and len(data) < MAX_SINGLE_ITEMS


def corpus() -> list[bytes]:
    return [
        *(cbor2.dumps(json.loads(each)) for each in seeds.frames() if is_json(each)),
        cbor2.dumps({"a": cbor2.CBORTag(64, b"\1\2"), "b": cbor2.CBORTag(68, b"")}),
        *(cbor2.dumps(cbor2.CBORTag(tag, bytes(range(24)))) for tag in TYPED),
        cbor2.dumps([1.5, -1, 2**64 - 1, -(2**63), None, True, b"octets", "\u00fc", {}]),
        b"\xf9\x3e\x00",
        b"\x81" * 40 + b"\x01",
        b"\xbf\x61a\x5f\x41b\xff\xff",
    ]


def is_json(data: bytes) -> bool:
    try:
        json.loads(data)
    except ValueError:
        return False
    return True


TARGET = Target("CBOR is read as another reader does, or refused with words", run, corpus)
