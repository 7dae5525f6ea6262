# SPDX-License-Identifier: Apache-2.0
import math

import pytest

from gateway.codec.types import Types
from gateway.codec.validation import InvalidValueError
from schemas.installed import InstalledDefinitions

TWIST = "geometry_msgs/msg/Twist"
POSES = "geometry_msgs/msg/PoseArray"
COVARIANCE = "geometry_msgs/msg/PoseWithCovariance"
JPEG = "sensor_msgs/msg/CompressedImage"
TIME = "builtin_interfaces/msg/Time"


@pytest.fixture(scope="module")
def types():
    return Types(InstalledDefinitions())


def reason_of(types, name, value):
    with pytest.raises(InvalidValueError) as caught:
        types.get(name).encode(value, now_ns=0)
    return str(caught.value)


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [
        (TWIST, {"linear": {"x": "1"}}, "msg.linear.x: expected a number, got a string"),
        (TWIST, {"linear": {"x": True}}, "msg.linear.x: expected a number, got true"),
        (TWIST, {"linear": None}, "msg.linear: expected an object, got null"),
        ("std_msgs/msg/Int8", {"data": 1.5}, "msg.data: expected an integer, got 1.5"),
        ("std_msgs/msg/Int8", {"data": math.nan}, "msg.data: expected an integer, got NaN"),
        ("std_msgs/msg/Int8", {"data": 128.0},
         "msg.data: 128.0 is out of range for int8 (-128 to 127)"),
        ("std_msgs/msg/UInt64", {"data": 1e19}, "msg.data: expected an integer, got 1e+19"),
        ("std_msgs/msg/Bool", {"data": 1.0}, "msg.data: expected true or false, got 1.0"),
        ("std_msgs/msg/String", {"data": math.inf}, "msg.data: expected a string, got Infinity"),
        ("std_msgs/msg/Float32", {"data": "inf"}, "msg.data: expected a number, got a string"),
        (
            "std_msgs/msg/Float32MultiArray",
            {"data": ["NaN", math.nan, math.inf, None, "Infinity", 1e39]},
            "msg.data[5]: 1e+39 is out of range for float32",
        ),
        (
            "std_msgs/msg/Int16MultiArray",
            {"data": [1.0, -32768.0, "NaN"]},
            "msg.data[2]: expected an integer, got a string",
        ),
        (TWIST, {"linear": 5}, "msg.linear: expected an object, got 5"),
        (TWIST, [], "msg: expected an object, got an array"),
        ("std_msgs/msg/UInt8", {"data": 1.5}, "msg.data: expected an integer, got 1.5"),
        ("std_msgs/msg/UInt8", {"data": {}}, "msg.data: expected an integer, got an object"),
        ("std_msgs/msg/Bool", {"data": 1}, "msg.data: expected true or false, got 1"),
        ("std_msgs/msg/String", {"data": 1}, "msg.data: expected a string, got 1"),
        (POSES, {"poses": {}}, "msg.poses: expected an array, got an object"),
        (POSES, {"poses": [{}, {"position": {"x": []}}]},
         "msg.poses[1].position.x: expected a number, got an array"),
        (JPEG, {"data": 5}, "msg.data: expected base64 text or an array of integers"),
        (JPEG, {"data": "?"}, "msg.data: text is not valid base64"),
        (JPEG, {"data": [1, 256]}, "msg.data: item 1 is not an integer from 0 to 255"),
    ],
)  # fmt: skip
def test_a_wrong_kind_is_named_with_path_and_expectation(types, name, value, reason):
    assert reason_of(types, name, value) == reason


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [
        ("std_msgs/msg/UInt8", {"data": 300}, "msg.data: 300 is out of range for uint8 (0 to 255)"),
        ("std_msgs/msg/Int8", {"data": -129},
         "msg.data: -129 is out of range for int8 (-128 to 127)"),
        ("std_msgs/msg/Float32", {"data": 1e39}, "msg.data: 1e+39 is out of range for float32"),
        (TIME, {"nanosec": 2**32},
         "msg.nanosec: 4294967296 is out of range for uint32 (0 to 4294967295)"),
        ("std_msgs/msg/Header", {"stamp": {"nanosec": -1}},
         "msg.stamp.nanosec: -1 is out of range for uint32 (0 to 4294967295)"),
    ],
)  # fmt: skip
def test_a_number_out_of_range_is_named_with_its_range(types, name, value, reason):
    assert reason_of(types, name, value) == reason


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [
        (COVARIANCE, {"covariance": [0.0] * 35}, "msg.covariance: expected 36 elements, got 35"),
        ("unique_identifier_msgs/msg/UUID", {"uuid": "AAAA"},
         "msg.uuid: expected 16 elements, got 3"),
        ("test_msgs/msg/BoundedSequences", {"int8_values": [1] * 4},
         "msg.int8_values: expected at most 3 elements, got 4"),
        ("test_msgs/msg/Strings", {"bounded_string_value": "ü" * 12},
         "msg.bounded_string_value: text has 24 bytes of UTF-8, at most 22 fit"),
    ],
)  # fmt: skip
def test_a_wrong_length_is_named_with_the_right_one(types, name, value, reason):
    assert reason_of(types, name, value) == reason


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("a\0b", "msg.data: a string cannot hold U+0000"),
        ("\ud800", "msg.data: a string cannot hold a lone surrogate"),
    ],
)
def test_text_without_encoding_is_refused_in_words(types, text, reason):
    assert reason_of(types, "std_msgs/msg/String", {"data": text}) == reason


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [
        (TWIST, {"lineal": {}},
         "msg.lineal: unknown field of geometry_msgs/msg/Twist; did you mean linear?"),
        (TWIST, {"speed": 1},
         "msg.speed: unknown field of geometry_msgs/msg/Twist, which has linear, angular"),
        (TWIST, {"linear": {"X": 1}},
         "msg.linear.X: unknown field of geometry_msgs/msg/Vector3, which has x, y, z"),
        (POSES, {"poses": [{"positon": {}}]},
         "msg.poses[0].positon: unknown field of geometry_msgs/msg/Pose; did you mean position?"),
        ("std_msgs/msg/Empty", {"a": 1},
         "msg.a: unknown field of std_msgs/msg/Empty, which is empty"),
    ],
)  # fmt: skip
def test_an_unknown_field_is_named_with_what_there_is(types, name, value, reason):
    assert reason_of(types, name, value) == reason


def test_an_unknown_field_is_compared_by_its_first_128_characters(tmp_path):
    name = "a" * 128
    path = tmp_path / "share/some_msgs/msg/Long.msg"
    path.parent.mkdir(parents=True)
    path.write_text(f"bool {name}\n")
    some = Types(InstalledDefinitions([tmp_path]))
    reason = reason_of(some, "some_msgs/msg/Long", {name + "b" * 1000: True})
    assert reason.endswith(f"did you mean {name}?")


def test_three_problems_are_named_and_the_others_counted(types):
    value = {"linear": {"x": "a", "y": "b"}, "angular": {"x": "c", "y": "d", "q": 1}}
    assert reason_of(types, TWIST, value) == (
        "msg.linear.x: expected a number, got a string; "
        "msg.linear.y: expected a number, got a string; "
        "msg.angular.x: expected a number, got a string (and 2 more)"
    )


def test_the_path_is_that_of_the_first_problem(types):
    with pytest.raises(InvalidValueError) as caught:
        types.get(POSES).encode({"poses": [{"position": {"x": "a", "y": "b"}}]}, now_ns=0)
    assert caught.value.path == "msg.poses[0].position.x"


def test_a_client_s_text_is_cut(types):
    reason = reason_of(types, TWIST, {"x" * 10_000: 1, "y" * 10_000: 1, "z" * 10_000: 1})
    assert len(reason) < 1000
    assert f"msg.{'x' * 124}...: unknown field" in reason
