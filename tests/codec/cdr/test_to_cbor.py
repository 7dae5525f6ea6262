# SPDX-License-Identifier: Apache-2.0
import math
import random
import struct

import cbor2
import pytest
from rclpy.serialization import serialize_message

from gateway.codec.cdr import compile_decoder, compile_transcoder
from gateway.codec.error_text import CodecError
from schemas.installed import InstalledDefinitions
from tests.codec.cdr.reference import Writer
from tests.messages import RandomMessages, to_ros
from tests.wire import untagged

DEFINITIONS = InstalledDefinitions()
NAMES = DEFINITIONS.names()

ARRAYS = "test_msgs/msg/Arrays"
SEQUENCES = "test_msgs/msg/UnboundedSequences"
ODOMETRY = "nav_msgs/msg/Odometry"
TAGS = {
    "uint16": 69,
    "uint32": 70,
    "uint64": 71,
    "int8": 72,
    "int16": 77,
    "int32": 78,
    "int64": 79,
    "float32": 85,
    "float64": 86,
}


def transcoder_of(name, fields=None):
    return compile_transcoder(DEFINITIONS.get(name), DEFINITIONS, fields)


def cdr_of(name, values, order="<", padding=0):
    return Writer(DEFINITIONS, order, padding).message(DEFINITIONS.get(name), values)


def samples(name, longest=4):
    for seed in range(3):
        yield RandomMessages(DEFINITIONS, seed, longest).message(name)


@pytest.mark.parametrize("name", NAMES)
def test_every_type_becomes_a_map_with_the_same_values_from_either_byte_order(name):
    transcode = transcoder_of(name)
    for values in samples(name):
        for order in "<>":
            cdr = cdr_of(name, values, order, padding=0xA5)
            found = cbor2.loads(transcode(cdr))
            assert untagged(found) == values
            assert transcode(memoryview(cdr)) == transcode(cdr)
            assert list(found) == [field.name for field in DEFINITIONS.get(name).fields]


@pytest.mark.parametrize("name", [ODOMETRY, SEQUENCES, ARRAYS, "sensor_msgs/msg/PointCloud2"])
def test_messages_of_rclpy_are_transcoded(name):
    definition = DEFINITIONS.get(name)
    for values in samples(name):
        cdr = serialize_message(to_ros(definition, DEFINITIONS, values))
        assert untagged(cbor2.loads(transcoder_of(name)(cdr))) == values


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize(("base", "tag"), TAGS.items())
def test_arrays_of_numbers_are_typed_short_and_empty_ones_too(base, tag, order):
    transcode = transcoder_of(SEQUENCES, (f"{base}_values",))
    empty = RandomMessages(DEFINITIONS, 0, longest=0).message(SEQUENCES)
    for items in ([], [1], [1, 2, 3] * 30):
        cdr = cdr_of(SEQUENCES, empty | {f"{base}_values": items}, order)
        found = cbor2.loads(transcode(cdr))[f"{base}_values"]
        assert (type(found), found.tag) == (cbor2.CBORTag, tag)
        assert untagged(found) == items


@pytest.mark.parametrize(("base", "tag"), TAGS.items())
def test_fixed_arrays_of_numbers_are_typed(base, tag):
    values = RandomMessages(DEFINITIONS, 1).message(ARRAYS)
    found = cbor2.loads(transcoder_of(ARRAYS)(cdr_of(ARRAYS, values)))[f"{base}_values"]
    assert found.tag == tag
    assert untagged(found) == values[f"{base}_values"]


@pytest.mark.parametrize("base", ["uint8", "char", "byte"])
def test_octets_are_byte_strings_and_booleans_and_strings_plain_arrays(base):
    values = RandomMessages(DEFINITIONS, 1).message(SEQUENCES)
    found = cbor2.loads(transcoder_of(SEQUENCES)(cdr_of(SEQUENCES, values)))
    assert found[f"{base}_values"] == values[f"{base}_values"]
    assert isinstance(found[f"{base}_values"], bytes)
    assert found["bool_values"] == values["bool_values"]
    assert found["string_values"] == values["string_values"]


@pytest.mark.parametrize("octet", [1, 7, 255])
def test_any_octet_but_zero_is_true(octet):
    cdr = cdr_of("std_msgs/msg/Bool", {"data": True})[:-1] + bytes([octet])
    assert cbor2.loads(transcoder_of("std_msgs/msg/Bool")(cdr)) == {"data": True}
    empty = RandomMessages(DEFINITIONS, 0, longest=0).message(SEQUENCES)
    cdr = bytearray(cdr_of(SEQUENCES, empty | {"bool_values": [True, False]}))
    cdr[8] = octet
    found = cbor2.loads(transcoder_of(SEQUENCES, ("bool_values",))(bytes(cdr)))
    assert found == {"bool_values": [True, False]}


@pytest.mark.parametrize("name", ["std_msgs/msg/Float32", "std_msgs/msg/Float64"])
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_float_that_is_not_finite_stays_what_it_is_as_float64(name, value):
    item = transcoder_of(name)(cdr_of(name, {"data": value}))
    assert item[-9] == 0xFB
    assert struct.pack(">d", cbor2.loads(item)["data"]) == struct.pack(">d", value)


def test_a_time_is_sec_and_nanosec():
    name = "builtin_interfaces/msg/Time"
    for sec in (-(2**31), -1, 0, 2**31 - 1):
        values = {"sec": sec, "nanosec": 999_999_999}
        assert cbor2.loads(transcoder_of(name)(cdr_of(name, values))) == values


def test_fields_select_what_is_transcoded():
    values = next(samples(ODOMETRY))
    transcode = transcoder_of(ODOMETRY, ("header.stamp", "pose.covariance"))
    assert untagged(cbor2.loads(transcode(cdr_of(ODOMETRY, values)))) == {
        "header": {"stamp": values["header"]["stamp"]},
        "pose": {"covariance": values["pose"]["covariance"]},
    }


@pytest.mark.parametrize("name", NAMES)
def test_other_bytes_raise_as_in_the_decoder(name):
    definition = DEFINITIONS.get(name)
    transcode, decode = transcoder_of(name), compile_decoder(definition, DEFINITIONS)
    chance = random.Random(name)
    for values in samples(name, longest=2):
        for order in "<>":
            cdr = cdr_of(name, values, order)
            for _ in range(30):
                broken = bytearray(cdr)
                for _ in range(chance.randint(1, 4)):
                    broken[chance.randrange(4, len(broken))] = chance.choice([0, 1, 127, 255])
                cut = bytes(broken[: chance.randint(0, 2 * len(broken))])
                assert is_refused(transcode, cut) == is_refused(decode, cut)


def is_refused(codec, cdr):
    try:
        codec(cdr)
    except CodecError:
        return True
    return False
