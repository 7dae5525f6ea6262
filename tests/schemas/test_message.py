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
FIRST_INFINITE = 2.0**128 - 2.0**103  # half way from the largest to what would be the next


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


def holds(model, value, context=None):
    """Return the values that a message holds, without those that are the default."""
    return model.model_validate(value, context=context).model_dump(exclude_defaults=True)


FLOATS = [
    *((1, 1.0), (-2.5, -2.5), (None, None), (math.inf, math.inf)),
    *(("Infinity", math.inf), ("-Infinity", -math.inf)),
]


@pytest.mark.parametrize(
    ("model", "sent", "held"),
    [
        (Twist, {"linear": {"x": 0.5}}, {"linear": {"x": 0.5}}),
        (Quaternion, {}, {}),
        *((Twist, {"linear": {"x": sent}}, {"linear": {"x": held}}) for sent, held in FLOATS),
        *((ColorRGBA, {"r": sent}, {"r": held}) for sent, held in FLOATS),
        (LaserScan, {"ranges": [1, None]}, {"ranges": [1.0, None]}),
        (UInt8, {"data": 1.0}, {"data": 1}),
        (UInt8, {"data": -0.0}, {}),
        (Int64, {"data": 2.0**53}, {"data": 2**53}),
        (Int64, {"data": -(2.0**53)}, {"data": -(2**53)}),
        *(
            (String, {"data": sent}, {"data": sent})
            for sent in ("a", "zwölf\nZeilen", "ハロー", "😀")
        ),
        (Int8MultiArray, {"data": [-1]}, {"data": [-1]}),
        (Time, "now", {"sec": 7, "nanosec": 5}),
        *(
            (model, sent, {"sec": -1, "nanosec": 5})
            for model in (Time, Duration)
            for sent in (
                {"sec": -1, "nanosec": 5},
                {"secs": -1, "nsecs": 5},
                {"sec": -1, "nsecs": 5},
            )
        ),
        *((Time, {"nanosec": nanosec}, {"nanosec": nanosec}) for nanosec in (10**9, 2**32 - 1)),
        (
            PoseStamped,
            {"header": {"stamp": "now"}},
            {"header": {"stamp": {"sec": 7, "nanosec": 5}}},
        ),
        (PoseStamped, {}, {}),  # an absent header keeps stamp zero
        # which rosbridge's clients send
        (Header, {"seq": 3, "stamp": {"sec": 1}}, {"stamp": {"sec": 1}}),
        (Header, {"frame_id": "map"}, {"stamp": {"sec": 7, "nanosec": 5}, "frame_id": "map"}),
    ],
)
def test_a_value_is_taken(model, sent, held):
    assert holds(model, sent, NOW) == held
    assert model.model_validate({}) == model()


@pytest.mark.parametrize(
    ("model", "sent", "path", "kind"),
    [
        (Twist, {"linear": {"w": 1}}, ("linear", "w"), "extra_forbidden"),
        *(
            (model, {"data": sent}, ("data",), "")
            for model, values in (
                (UInt8, [1.5, math.inf, math.nan, True, "1", None]),
                (UInt64, [2.0**53 + 2]),
                (Int64, [-1e300]),
                (Bool, [0, 1, "true", None]),
                (String, ["a\0b", "\0", "\ud800", "a\udfff", b"a", 1, None]),
            )
            for sent in values
        ),
        *(
            (Twist, {"linear": {"x": sent}}, ("linear", "x"), "")
            for sent in (True, "1", "inf", "+Infinity", "nan", [], {}, 10**400)
        ),
        (ColorRGBA, {"r": 1e39}, ("r",), "float32_type"),
        (ColorRGBA, {"r": -(10**39)}, ("r",), "float32_type"),
        (ColorRGBA, {"r": FIRST_INFINITE}, ("r",), "float32_type"),
        (UInt8, {"data": 256.0}, ("data",), "less_than_equal"),
        # one bad element is enough
        (Float64MultiArray, {"data": ["x"] * 1000}, ("data", 0), "float64_type"),
        (LaserScan, {"ranges": [1.0, "x"]}, ("ranges", 1), "float32_type"),
        (Int8MultiArray, {"data": "AQ=="}, ("data",), "list_type"),
        *(
            (model, *fault)
            for model in (Time, Duration)
            for fault in (
                ({"sec": 1, "secs": 2}, ("secs",), "extra_forbidden"),
                ({"nanosec": 2**32}, ("nanosec",), "less_than_equal"),
                ({"nanosec": -1}, ("nanosec",), "greater_than_equal"),
            )
        ),
        *((Time, sent, (), "model_type") for sent in ("Now", "", 1, None, [1, 2])),
        (Duration, "now", (), "model_type"),
    ],
)
def test_any_other_value_is_refused_with_its_path(model, sent, path, kind):
    found = refusal(model, sent, NOW)
    assert found[0] == path
    assert found[1] == (kind or found[1])


def test_messages_are_frozen_and_share_no_default_list():
    with pytest.raises(ValidationError):
        Twist().linear = None
    one, other = Models.installed().get("sensor_msgs/msg/Imu")(), LaserScan()
    assert one.orientation_covariance == [0.0] * 9
    assert type(one)().orientation_covariance is not one.orientation_covariance
    assert LaserScan().ranges is not other.ranges
    assert Quaternion().w == 1.0  # the default of the definition


@pytest.mark.parametrize("sent", ["NaN", math.nan])
def test_nan_is_taken_by_its_name_too(sent):
    assert math.isnan(Twist.model_validate({"linear": {"x": sent}}).linear.x)
    assert math.isnan(ColorRGBA.model_validate({"r": sent}).r)


@pytest.mark.parametrize("text", ["1e999", "NaN", "Infinity"])
def test_json_text_cannot_bring_a_non_finite_float(text):
    with pytest.raises(ValidationError):
        Twist.model_validate_json(f'{{"linear": {{"x": {text}}}}}')


@pytest.mark.parametrize("sent", [FLOAT32_MAX, -FLOAT32_MAX, 3.4028235e38, -3.4028235e38])
def test_the_largest_float32_is_taken_as_it_prints(sent):
    held = ColorRGBA.model_validate({"r": sent}).r
    assert abs(struct.unpack("<f", struct.pack("<f", held))[0]) == FLOAT32_MAX
    ColorRGBA.model_validate({"r": math.nextafter(FIRST_INFINITE, 0)})


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_float32_is_taken_exactly_if_single_precision_holds_it(sent):
    try:
        struct.pack("<f", sent)
    except OverflowError:
        assert refusal(ColorRGBA, {"r": sent})[0] == ("r",)
    else:
        assert ColorRGBA.model_validate({"r": sent}).r == sent


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
