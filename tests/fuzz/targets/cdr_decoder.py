# SPDX-License-Identifier: Apache-2.0
"""Bytes that a node of ROS has sent: any type, any bytes."""

import math
from typing import Any

import cbor2
import numpy as np

from gateway.codec.cdr.misfits import TooManyFieldsError
from gateway.codec.error_text import CodecError
from gateway.codec.json import dumps, loads
from gateway.codec.validation import InvalidValueError
from tests.codec.cdr.reference import Writer
from tests.fuzz import types
from tests.fuzz.target import Target, check
from tests.messages import normalized
from tests.wire import untagged

HEADERS = (b"\0\1\0\0", b"\0\0\0\0")
SEEDED = (
    "std_msgs/msg/String",
    "geometry_msgs/msg/Twist",
    "nav_msgs/msg/Odometry",
    "sensor_msgs/msg/LaserScan",
    "sensor_msgs/msg/Image",
    "sensor_msgs/msg/PointCloud2",
    "visualization_msgs/msg/MarkerArray",
    "test_msgs/msg/UnboundedSequences",
    "test_msgs/msg/WStrings",
    "odd_msgs/msg/T7",
    "odd_msgs/msg/T23",
)


def run(data: bytes) -> None:
    """Take the type from the first two bytes, the byte order from the third."""
    message_type = types.chosen(data)
    cdr = HEADERS[data[2] & 1] + data[3:] if data[2:3] and data[2] < 250 else data[3:]
    try:
        values = message_type.decode(cdr)
    except CodecError as error:
        check(error.offset is not None and str(error), "refused without a place")
        check(not is_decoded(message_type.transcoder(), cdr), "CBOR takes what JSON does not")
        return
    text = dumps(values)
    check(len(text) < 100 * len(cdr) + 100_000, "grows", len(text))
    from_cbor = untagged(cbor2.loads(message_type.transcoder()(cdr)))
    raw = message_type.decoder(octets="raw")(cdr)
    check(same(normalized(raw), from_cbor), "CBOR differs")
    for field in message_type.definition.fields[:3]:
        part = message_type.decoder((field.name,))(cdr)
        check(same(normalized(part), {field.name: normalized(values)[field.name]}), field.name)
    come_back(message_type, text)


def is_decoded(decode: Any, cdr: bytes) -> bool:
    try:
        decode(cdr)
    except CodecError:
        return False
    return True


def come_back(message_type: Any, text: bytes) -> None:
    """Encode what was decoded, and decode it again.

    Strings that were not UTF-8 may have grown beyond their bound, and times may be invalid.
    """
    try:
        cdr = message_type.encode(loads(text), 0)
    except (InvalidValueError, TooManyFieldsError):
        return
    except CodecError as error:
        check("JSON" in str(error), str(error))
        return
    check(dumps(message_type.decode(cdr)) == text, "does not come back")


def same(one: Any, other: Any) -> bool:
    match one, other:
        case dict(), dict():
            return list(one) == list(other) and all(same(one[key], other[key]) for key in one)
        case memoryview() | bytes(), bytes():
            return bytes(one) == other
        case list() | tuple() | np.ndarray(), list() | tuple() | np.ndarray():
            return len(one) == len(other) and all(map(same, one, other))
        case float(), float():
            return one == other or (math.isnan(one) and math.isnan(other))
    return bool(one == other)


def corpus() -> list[bytes]:
    writers = [Writer(types.definitions()), Writer(types.definitions(), ">", padding=0xA5)]
    return [
        types.numbered(name)
        + bytes((number,))
        + writer.message(types.definitions().get(name), types.example(name, seed))[4:]
        for name in SEEDED
        for seed in range(3)
        for number, writer in enumerate(writers)
    ]


TARGET = Target("CDR is decoded, equally by all decoders, or refused with a place", run, corpus)
