# SPDX-License-Identifier: Apache-2.0
"""Values of clients that the models accept, and others that they refuse."""

import base64
import math
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from schemas.build import Models
from schemas.installed import InstalledDefinitions
from schemas.models.builtin_interfaces import Duration, Time
from schemas.models.geometry_msgs import PoseStamped, Quaternion, Twist
from schemas.models.sensor_msgs import CompressedImage, LaserScan
from schemas.models.std_msgs import (
    Bool,
    ColorRGBA,
    Float64MultiArray,
    Header,
    Int8,
    Int8MultiArray,
    Int16,
    Int32,
    Int64,
    String,
    UInt8,
    UInt16,
    UInt32,
    UInt64,
)

NOW = {"now_ns": 7_000_000_005}
FLOAT32_MAX = struct.unpack("<f", struct.pack("<I", 0x7F7FFFFF))[0]


@pytest.fixture
def model_of(tmp_path):
    """Return a function that makes a model of the text of a definition."""

    def make(text):
        folder = tmp_path / "share" / "made_up_msgs" / "msg"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "Thing.msg").write_text(text, encoding="utf-8")
        return Models(InstalledDefinitions([tmp_path])).get("made_up_msgs/msg/Thing")

    return make


def refusal(model, value, context=None):
    """Return path, kind and words of the one refusal that validation ends with."""
    with pytest.raises(ValidationError) as caught:
        model.model_validate(value, context=context)
    (error,) = caught.value.errors()
    return error["loc"], error["type"], error["msg"]


def test_missing_fields_default():
    assert Twist.model_validate({"linear": {"x": 0.5}}) == Twist.model_validate(
        {"linear": {"x": 0.5, "y": 0, "z": 0}, "angular": {"x": 0, "y": 0, "z": 0}}
    )


def test_a_default_of_the_definition_is_honoured():
    assert Quaternion.model_validate({}).w == 1.0


def test_an_unknown_field_is_refused_with_its_path():
    path, kind, _ = refusal(Twist, {"linear": {"w": 1}})

    assert (path, kind) == (("linear", "w"), "extra_forbidden")


def test_messages_are_frozen():
    with pytest.raises(ValidationError):
        Twist().linear = None


def test_two_messages_share_no_default_list():
    one, other = Models.installed().get("sensor_msgs/msg/Imu")(), LaserScan()

    assert one.orientation_covariance == [0.0] * 9
    assert type(one)().orientation_covariance is not one.orientation_covariance
    assert LaserScan().ranges is not other.ranges


@pytest.mark.parametrize(
    ("sent", "held"),
    [
        (1, 1.0),
        (-2.5, -2.5),
        (None, None),
        ("Infinity", math.inf),
        ("-Infinity", -math.inf),
        (math.inf, math.inf),
    ],
)
def test_a_float_is_taken_from_a_number_or_null_or_the_name_of_an_infinity(sent, held):
    assert Twist.model_validate({"linear": {"x": sent}}).linear.x == held
    assert ColorRGBA.model_validate({"r": sent}).r == held


@pytest.mark.parametrize("sent", ["NaN", math.nan])
def test_nan_is_taken_by_its_name_too(sent):
    assert math.isnan(Twist.model_validate({"linear": {"x": sent}}).linear.x)
    assert math.isnan(ColorRGBA.model_validate({"r": sent}).r)


@pytest.mark.parametrize("sent", [True, "1", "inf", "+Infinity", "nan", [], {}, 10**400])
def test_a_float_is_taken_from_nothing_else(sent):
    path, _, _ = refusal(Twist, {"linear": {"x": sent}})

    assert path == ("linear", "x")


@pytest.mark.parametrize("text", ["1e999", "NaN", "Infinity"])
def test_json_text_cannot_bring_a_non_finite_float(text):
    with pytest.raises(ValidationError):
        Twist.model_validate_json(f'{{"linear": {{"x": {text}}}}}')


@pytest.mark.parametrize("sent", [FLOAT32_MAX, -FLOAT32_MAX, 3.4028235e38, -3.4028235e38])
def test_the_largest_float32_is_taken_as_it_prints(sent):
    held = ColorRGBA.model_validate({"r": sent}).r

    assert abs(struct.unpack("<f", struct.pack("<f", held))[0]) == FLOAT32_MAX


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_float32_is_taken_exactly_if_single_precision_holds_it(sent):
    try:
        struct.pack("<f", sent)
    except OverflowError:
        assert refusal(ColorRGBA, {"r": sent})[0] == ("r",)
    else:
        assert ColorRGBA.model_validate({"r": sent}).r == sent


def test_a_float32_beyond_its_range_is_refused():
    assert refusal(ColorRGBA, {"r": 1e39})[1] == "float32_type"
    assert refusal(ColorRGBA, {"r": -(10**39)})[1] == "float32_type"
    first_infinite = 2.0**128 - 2.0**103  # half way from the largest to what would be the next
    assert refusal(ColorRGBA, {"r": first_infinite})[1] == "float32_type"
    ColorRGBA.model_validate({"r": math.nextafter(first_infinite, 0)})


def test_one_bad_element_of_an_array_is_enough():
    assert refusal(Float64MultiArray, {"data": ["x"] * 1000})[0] == ("data", 0)


@pytest.mark.parametrize(
    ("model", "low", "high"),
    [
        (UInt8, 0, 255),
        (UInt16, 0, 65_535),
        (UInt32, 0, 4_294_967_295),
        (UInt64, 0, 2**64 - 1),
        (Int8, -128, 127),
        (Int16, -32_768, 32_767),
        (Int32, -2_147_483_648, 2_147_483_647),
        (Int64, -(2**63), 2**63 - 1),
    ],
)
def test_an_integer_has_the_exact_range_of_its_type(model, low, high):
    assert model.model_validate({"data": low}).data == low
    assert model.model_validate({"data": high}).data == high
    assert refusal(model, {"data": low - 1})[1] == "greater_than_equal"
    assert refusal(model, {"data": high + 1})[1] == "less_than_equal"
    assert model.model_validate_json(f'{{"data": {high}}}').data == high


@pytest.mark.parametrize("sent", [True, "1", None])
def test_an_integer_is_taken_from_nothing_but_a_number(sent):
    assert refusal(UInt8, {"data": sent})[1] == "int_type"


@pytest.mark.parametrize(
    ("model", "sent"), [(UInt8, 1.0), (UInt8, -0.0), (Int64, 2.0**53), (Int64, -(2.0**53))]
)
def test_a_float_without_a_fraction_is_an_integer(model, sent):
    held = model.model_validate({"data": sent}).data
    assert (type(held), held) == (int, int(sent))


@pytest.mark.parametrize(
    ("model", "sent"),
    [(UInt8, 1.5), (UInt8, math.inf), (UInt8, math.nan), (UInt64, 2.0**53 + 2), (Int64, -1e300)],
)
def test_a_float_that_may_not_be_an_integer_is_refused(model, sent):
    assert refusal(model, {"data": sent})[0] == ("data",)
    assert refusal(UInt8, {"data": 256.0})[1] == "less_than_equal"


@pytest.mark.parametrize("sent", [0, 1, "true", None])
def test_a_bool_is_taken_from_nothing_but_a_bool(sent):
    assert refusal(Bool, {"data": sent})[1] == "bool_type"


@pytest.mark.parametrize("sent", ["", "plain", "zwölf\nZeilen", "ハロー", "😀"])
def test_a_string_is_taken_as_it_is(sent):
    assert String.model_validate({"data": sent}).data == sent


@pytest.mark.parametrize("sent", ["a\0b", "\0", "\ud800", "a\udfff", b"a", 1, None])
def test_a_string_with_nul_or_lone_surrogate_or_another_value_is_refused(sent):
    assert refusal(String, {"data": sent})[0] == ("data",)


def test_a_bounded_string_counts_bytes_of_utf_8(model_of):
    model = model_of("string<=4 s")

    assert model.model_validate({"s": "éé"}).s == "éé"
    assert refusal(model, {"s": "ééa"}) == (
        ("s",),
        "string_too_long",
        "text has 5 bytes of UTF-8, at most 4 fit",
    )


def test_a_bounded_wide_string_counts_code_units_of_utf_16(model_of):
    model = model_of("wstring<=2 s")

    assert model.model_validate({"s": "😀"}).s == "😀"
    assert model.model_validate({"s": "éé"}).s == "éé"
    assert refusal(model, {"s": "😀a"})[2] == "text has 3 code units of UTF-16, at most 2 fit"


@pytest.mark.parametrize("base", ["uint8", "byte", "char"])
@pytest.mark.parametrize("sent", ["AQL/", [1, 2, 255], b"\x01\x02\xff"])
def test_octets_are_taken_from_base64_or_integers(model_of, base, sent):
    assert model_of(f"{base}[] data").model_validate({"data": sent}).data == b"\x01\x02\xff"


@given(st.binary())
def test_octets_come_back_from_base64_and_from_a_list(octets):
    text = base64.b64encode(octets).decode()

    assert CompressedImage.model_validate({"data": text}).data == octets
    assert CompressedImage.model_validate({"data": list(octets)}).data == octets
    assert CompressedImage.model_validate_json(f'{{"data": "{text}"}}').data == octets


@pytest.mark.parametrize("line_end", ["\n", "\r\n", " "])
@given(octets=st.binary())
def test_octets_are_taken_from_base64_in_lines(line_end, octets):
    text = base64.encodebytes(octets).decode().replace("\n", line_end)

    assert CompressedImage.model_validate({"data": text}).data == octets


def test_base64_in_lines_is_taken_up_to_4_mib():
    lines = "A" * 76 + "\n"
    most = lines * (4 * 1024**2 // len(lines))

    assert CompressedImage.model_validate({"data": most}).data
    assert refusal(CompressedImage, {"data": most + lines * 4})[2] == "text is not valid base64"


@pytest.mark.parametrize("sent", ["QQ", "QQ=", "QQ\n", "Q-__", "ä", "====", "A", "QQ\0=="])
def test_text_that_is_not_strict_base64_is_refused(sent):
    assert refusal(CompressedImage, {"data": sent})[1:] == ("octets", "text is not valid base64")


@pytest.mark.parametrize("bad", [256, -1, 1.5, True, "1", None])
def test_octets_in_a_list_are_integers_and_the_first_bad_one_is_named(bad):
    assert refusal(CompressedImage, {"data": [0, 255, bad, bad]}) == (
        ("data",),
        "octets",
        "item 2 is not an integer from 0 to 255",
    )


@pytest.mark.parametrize("sent", [None, 1, {}, True])
def test_octets_are_taken_from_nothing_else(sent):
    reason = "expected base64 text or an array of integers"
    assert refusal(CompressedImage, {"data": sent})[1:] == ("octets", reason)


def test_int8_arrays_are_not_octets():
    assert Int8MultiArray.model_validate({"data": [-1]}).data == [-1]
    assert refusal(Int8MultiArray, {"data": "AQ=="})[1] == "list_type"


@pytest.mark.parametrize("line", ["uint8[3] a", "float64[3] a", "string[3] a"])
def test_a_fixed_array_has_exactly_its_length(model_of, line):
    item = "x" if "string" in line else 1
    model = model_of(line)

    assert len(model.model_validate({}).a) == 3
    assert len(model.model_validate({"a": [item] * 3}).a) == 3
    assert refusal(model, {"a": [item] * 2})[1].endswith("too_short")
    assert refusal(model, {"a": [item] * 4})[1].endswith("too_long")


@pytest.mark.parametrize("line", ["uint8[<=3] a", "float64[<=3] a", "string[<=3] a"])
def test_a_bounded_sequence_has_at_most_its_bound(model_of, line):
    item = "x" if "string" in line else 1
    model = model_of(line)

    assert len(model.model_validate({}).a) == 0
    assert len(model.model_validate({"a": [item] * 3}).a) == 3
    assert refusal(model, {"a": [item] * 4})[1].endswith("too_long")


def test_octets_of_a_fixed_array_in_base64_have_its_length_too(model_of):
    model = model_of("uint8[3] a")

    assert model.model_validate({"a": "AQID"}).a == b"\x01\x02\x03"
    assert refusal(model, {"a": "AQI="})[1].endswith("too_short")


def test_an_item_of_an_array_is_refused_with_its_index():
    assert refusal(LaserScan, {"ranges": [1.0, "x"]})[0] == ("ranges", 1)


def test_null_in_an_array_of_floats_is_kept():
    assert LaserScan.model_validate({"ranges": [1, None]}).ranges == [1.0, None]


@pytest.mark.parametrize("model", [Time, Duration])
@pytest.mark.parametrize(
    "sent",
    [
        {"sec": -1, "nanosec": 5},
        {"secs": -1, "nsecs": 5},
        {"sec": -1, "nsecs": 5},
    ],
)
def test_a_time_is_taken_in_the_forms_of_ros_1_and_2(model, sent):
    assert model.model_validate(sent) == model(sec=-1, nanosec=5)


@pytest.mark.parametrize("model", [Time, Duration])
def test_a_time_in_both_forms_at_once_is_refused(model):
    assert refusal(model, {"sec": 1, "secs": 2})[:2] == (("secs",), "extra_forbidden")


@pytest.mark.parametrize("model", [Time, Duration])
def test_nanoseconds_may_be_more_than_a_second(model):
    for nanosec in (999_999_999, 10**9, 2**32 - 1):
        assert model.model_validate({"nanosec": nanosec}).nanosec == nanosec
    assert refusal(model, {"nanosec": 2**32})[:2] == (("nanosec",), "less_than_equal")
    assert refusal(model, {"nanosec": -1})[:2] == (("nanosec",), "greater_than_equal")


def test_now_is_the_time_of_the_context():
    assert Time.model_validate("now", context=NOW) == Time(sec=7, nanosec=5)
    assert PoseStamped.model_validate(
        {"header": {"stamp": "now"}}, context=NOW
    ).header.stamp == Time(sec=7, nanosec=5)


def test_now_before_1970_has_nanoseconds_that_count_up():
    assert Time.model_validate("now", context={"now_ns": -1}) == Time(sec=-1, nanosec=999_999_999)


def test_a_clock_is_asked_where_a_message_says_now_and_only_there():
    asked = []

    def clock() -> int:
        asked.append(True)
        return 3_000_000_007

    context = {"now_ns": clock}
    assert PoseStamped.model_validate({"pose": {}}, context=context).header.stamp == Time()
    assert not asked
    stamped = PoseStamped.model_validate({"header": {"frame_id": "map"}}, context=context)
    assert stamped.header.stamp == Time(sec=3, nanosec=7)


def test_now_without_a_clock_is_refused():
    assert refusal(Time, "now")[1:] == ("no_clock", "no clock says what time is now")


@pytest.mark.parametrize("sent", ["Now", "", 1, None, [1, 2]])
def test_a_time_is_taken_from_nothing_else(sent):
    assert refusal(Time, sent, NOW)[1] == "model_type"


def test_a_duration_is_never_now():
    assert refusal(Duration, "now", NOW)[1] == "model_type"


def test_the_seq_of_a_header_is_ignored():
    sent = {"seq": 3, "stamp": {"sec": 1}, "frame_id": "map"}

    assert Header.model_validate(sent, context=NOW) == Header(stamp=Time(sec=1), frame_id="map")
    assert sent["seq"] == 3


def test_a_header_without_stamp_is_stamped_now():
    held = PoseStamped.model_validate({"header": {"frame_id": "map"}}, context=NOW)

    assert held.header == Header(stamp=Time(sec=7, nanosec=5), frame_id="map")


def test_an_absent_header_keeps_stamp_zero():
    assert PoseStamped.model_validate({}, context=NOW).header.stamp == Time(sec=0, nanosec=0)


def test_a_header_without_stamp_or_clock_keeps_stamp_zero():
    assert Header.model_validate({"frame_id": "map"}).stamp == Time(sec=0, nanosec=0)


def test_json_text_is_held_to_the_same_rules():
    held = PoseStamped.model_validate_json(
        '{"header": {"seq": 1, "stamp": {"secs": 1}}, "pose": {"position": {"x": 1}}}'
    )

    assert held == PoseStamped.model_validate(
        {"header": {"stamp": {"sec": 1}}, "pose": {"position": {"x": 1.0}}}
    )


def test_a_field_whose_name_python_owns_is_sent_under_its_own_name(model_of):
    model = model_of("int8 from\nint8 copy\nint8 int\nint8 list\nint8[] str\nint8 ros")
    held = model.model_validate({"from": 1, "copy": 2, "int": 3, "list": 4, "str": [5], "ros": 6})

    assert (held.from_, held.copy_, held.int_, held.list_, held.str_, held.ros_) == (
        *(1, 2, 3, 4),
        [5],
        6,
    )
    assert refusal(model, {"from_": 1})[1] == "extra_forbidden"
