# SPDX-License-Identifier: Apache-2.0
"""A long array of numbers is encoded as the list of its numbers is, or refused for the same."""

import base64
import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from gateway.codec.cdr.misfits import TooManyFieldsError
from gateway.codec.error_text import CodecError
from gateway.codec.types import Types
from schemas.definition import FLOAT32_OVERFLOW
from schemas.installed import InstalledDefinitions
from schemas.json_forms import NumberArray

TYPES = Types(InstalledDefinitions())
BASES = ["Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64"]
DTYPES = ["i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "f4", "f8"]
INTEGERS = [0, 1, -1, 127, 128, -128, -129, 255, 256, 2**15, 2**31, 2**52, 2**63 - 1, -(2**63)]
FLOATS = [0.5, 1e10, -3.0, 1e300, FLOAT32_OVERFLOW, 3.4028235e38, math.inf, math.nan]
NUMBERS = st.sampled_from([*INTEGERS, *FLOATS])


def encoded(name: str, data: object) -> bytes | str:
    try:
        return TYPES.get(f"std_msgs/msg/{name}MultiArray").encode({"data": data}, 0)
    except CodecError as error:
        return str(error)


@given(
    st.sampled_from([*BASES, "Float32", "Float64"]),
    st.lists(NUMBERS, min_size=1, max_size=4),
    st.sampled_from(DTYPES),
)
@example("Int8", [1, 2, 300], "i4")
@example("Float32", [2**63 - 1], "i8")
def test_an_array_is_encoded_as_its_list(name, numbers, dtype):
    with np.errstate(all="ignore"):
        array = np.array(numbers, np.float64).astype(dtype)
    found, expected = encoded(name, NumberArray(array)), encoded(name, array.tolist())
    if isinstance(expected, str):  # of several misfits another one may be named
        assert isinstance(found, str)
        assert found.startswith("msg.data")
    else:
        assert found == expected


@pytest.mark.parametrize("name", [*BASES, "Float32", "Float64"])
def test_booleans_are_not_numbers(name):
    assert "msg.data" in str(encoded(name, NumberArray(np.zeros(2, np.bool_))))


def test_an_integer_that_a_float_cannot_hold_for_sure_is_refused():
    array = NumberArray(np.array([1.0, 2.0**53]))
    assert "msg.data[1]: 9007199254740992.0 stands for several" in str(encoded("Int64", array))


def test_int8_takes_base64_and_bytes_as_uint8_does():
    data = bytes(range(256))
    numbers = np.frombuffer(data, np.int8).tolist()
    for value in (data, base64.b64encode(data).decode()):
        assert encoded("Int8", value) == encoded("Int8", numbers)
    assert "msg.data: text is not valid base64" in str(encoded("Int8", "@@@"))
    assert "msg.data: expected an array, got a string" in str(encoded("Int16", "AAAA"))


def test_numbers_take_no_more_than_a_message_may():
    with pytest.raises(TooManyFieldsError, match="16777216 bytes"):
        TYPES.get("std_msgs/msg/Float64MultiArray").encode(
            {"data": NumberArray(np.zeros(2 * 1024**2 + 1, np.int8))}, 0
        )


def test_an_array_may_be_that_of_a_fixed_length():
    covariance = np.arange(36.0)
    pose = TYPES.get("geometry_msgs/msg/PoseWithCovariance")
    expected = pose.encode({"covariance": covariance.tolist()}, 0)
    assert pose.encode({"covariance": NumberArray(covariance)}, 0) == expected
    with pytest.raises(CodecError, match="covariance: expected 36 elements, got 35"):
        pose.encode({"covariance": NumberArray(covariance[1:])}, 0)
