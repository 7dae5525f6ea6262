# SPDX-License-Identifier: Apache-2.0
import json
import math
import random
import struct

import pytest
from rclpy.serialization import deserialize_message, serialize_message

from gateway.codec.cdr import compile_decoder, compile_encoder
from gateway.codec.cdr.layout import flatten
from gateway.codec.cdr.misfits import MISFITS, TooManyFieldsError, count_fields
from gateway.codec.json import dumps
from schemas.definition import PRIMITIVES
from schemas.installed import InstalledDefinitions
from tests.codec.cdr.reference import Writer
from tests.messages import RandomMessages, from_ros, normalized, ros_class, to_json

DEFINITIONS = InstalledDefinitions()
NAMES = DEFINITIONS.names()

STRING = "std_msgs/msg/String"
POSE = "geometry_msgs/msg/PoseWithCovariance"


def encoder_of(name):
    return compile_encoder(DEFINITIONS.get(name), DEFINITIONS)


def encoded(name, **changes):
    """Encode a message with the values that *changes* does not state made up."""
    values = RandomMessages(DEFINITIONS, 0, longest=2).message(name)
    return encoder_of(name)(to_json(values) | changes, 0)


def samples(name):
    for seed in range(3):
        yield RandomMessages(DEFINITIONS, seed).message(name)


@pytest.mark.parametrize("name", NAMES)
def test_messages_are_encoded_as_the_reference_writes_them(name):
    encode = encoder_of(name)
    writer = Writer(DEFINITIONS)
    for values in samples(name):
        assert encode(to_json(values), 0) == writer.message(DEFINITIONS.get(name), values)


@pytest.mark.parametrize("name", NAMES)
def test_rclpy_reads_what_is_encoded(name):
    encode = encoder_of(name)
    for values in samples(name):
        message = deserialize_message(encode(to_json(values), 0), ros_class(name))
        assert from_ros(DEFINITIONS.get(name), DEFINITIONS, message) == values


def test_none_is_nan_for_a_float():
    encode = encoder_of("geometry_msgs/msg/Vector3")
    x, y, z = struct.unpack("<4x3d", encode({"x": 1.5, "y": None, "z": -2.0}, 0))
    assert (x, z) == (1.5, -2.0)
    assert math.isnan(y)


@pytest.mark.parametrize("length", [4, 60])
def test_none_is_nan_in_a_sequence_of_floats(length):
    cdr = encoded("sensor_msgs/msg/LaserScan", ranges=[None, 1.0] * length, intensities=[None])
    decode = compile_decoder(DEFINITIONS.get("sensor_msgs/msg/LaserScan"), DEFINITIONS)
    scan = decode(cdr)
    assert math.isnan(scan["ranges"][0])
    assert scan["ranges"][1] == 1.0
    assert math.isnan(scan["intensities"][0])


def test_none_is_nan_in_a_fixed_array():
    cdr = encoded(POSE, covariance=[None] * 36)
    assert all(math.isnan(value) for value in struct.unpack_from("<36d", cdr, 60))


NAMED = ["Infinity", "-Infinity", "NaN", math.inf, -math.inf, math.nan, None]


@pytest.mark.parametrize("name", ["float64", "float32"])
def test_non_finite_numbers_are_taken_by_name_as_numbers_and_as_null(name):
    cdr = encoded(f"std_msgs/msg/{name.title()}MultiArray", data=[1.5, *NAMED])
    code = "d" if name == "float64" else "f"
    first, *found = struct.unpack_from(f"<8{code}", cdr, len(cdr) - 8 * struct.calcsize(code))
    assert first == 1.5
    assert list(map(str, found)) == ["inf", "-inf", "nan", "inf", "-inf", "nan", "nan"]
    for value, number in zip(NAMED, found, strict=True):
        cdr = encoded(f"std_msgs/msg/{name.title()}", data=value)
        assert str(struct.unpack_from(f"<{code}", cdr, 4)[0]) == str(number)


@pytest.mark.parametrize("value", ["", "inf", "nan", "+Infinity", "infinity", "1", " NaN"])
def test_no_other_text_is_a_float(value):
    for name in ("Float32", "Float64"):
        with pytest.raises(MISFITS):
            encoded(f"std_msgs/msg/{name}", data=value)
        with pytest.raises(MISFITS):
            encoded(f"std_msgs/msg/{name}MultiArray", data=[1.0, value])


def test_a_float_without_a_fraction_is_taken_as_an_integer():
    for name, whole in {"Int8": -128, "UInt16": 65535, "Int64": -(2**53), "UInt64": 2**53}.items():
        for value in (whole, float(whole)):
            assert encoded(f"std_msgs/msg/{name}", data=value) == encoded(
                f"std_msgs/msg/{name}", data=whole
            )
    assert encoded("std_msgs/msg/Int32MultiArray", data=[1, 2.0, -0.0]) == encoded(
        "std_msgs/msg/Int32MultiArray", data=[1, 2, 0]
    )
    assert encoded("std_msgs/msg/UInt8MultiArray", data=[1.0, 255]) == encoded(
        "std_msgs/msg/UInt8MultiArray", data=[1, 255]
    )


@pytest.mark.parametrize("value", [1.5, 128.0, math.inf, math.nan, "1", "Infinity", None, True])
def test_a_float_that_may_not_be_an_integer_is_a_misfit(value):
    with pytest.raises(MISFITS):
        encoded("std_msgs/msg/Int8", data=value)
    with pytest.raises(MISFITS):
        encoded("std_msgs/msg/Int8MultiArray", data=[1, value])


@pytest.mark.parametrize("value", [None, "1", 2.0**53 + 2, True, 2**63, -(2**63) - 1])
def test_a_value_without_encoding_is_a_misfit(value):
    with pytest.raises(MISFITS):
        encoded("std_msgs/msg/Int64", data=value)


def test_a_float_beyond_float32_is_a_misfit():
    with pytest.raises(MISFITS):
        encoded("std_msgs/msg/Float32", data=1e39)


@pytest.mark.parametrize("text", ["\ud83d", "a\0b", b"a", ["a"]])
def test_text_that_cdr_cannot_hold_is_a_misfit(text):
    for name in (STRING, "test_msgs/msg/WStrings"):
        field = DEFINITIONS.get(name).fields[0].name
        with pytest.raises(MISFITS):
            encoded(name, **{field: text})


@pytest.mark.parametrize("length", [35, 37])
def test_a_fixed_array_of_another_length_is_a_misfit(length):
    with pytest.raises(MISFITS):
        encoded(POSE, covariance=[0.0] * length)


@pytest.mark.parametrize(
    ("name", "field", "value"),
    [
        ("Arrays", "uint8_values", [1, 2]),
        ("Arrays", "int16_values", [1] * 4),
        ("Arrays", "string_values", ["a"]),
        ("Arrays", "basic_types_values", []),
        ("BoundedSequences", "int8_values", [1] * 4),
        ("BoundedSequences", "uint8_values", [1] * 4),
        ("BoundedSequences", "string_values", [""] * 4),
        ("Strings", "bounded_string_value", "ü" * 12),
    ],
)
def test_a_wrong_length_is_a_misfit(name, field, value):
    with pytest.raises(MISFITS):
        encoded(f"test_msgs/msg/{name}", **{field: value})


@pytest.mark.parametrize("empty", ["", {}, None, 0, ()])
def test_an_empty_value_that_is_not_an_array_is_a_misfit(empty):
    for field in ("ranges", "intensities"):
        with pytest.raises(MISFITS):
            encoded("sensor_msgs/msg/LaserScan", **{field: empty})
    with pytest.raises(MISFITS):
        encoded("nav_msgs/msg/Path", poses=empty)


@pytest.mark.parametrize("empty", ["", [], None, 0])
def test_an_empty_value_that_is_not_an_object_is_a_misfit(empty):
    with pytest.raises(MISFITS):
        encoder_of("std_msgs/msg/Empty")(empty, 0)
    with pytest.raises(MISFITS):
        encoder_of("nav_msgs/msg/Path")({"poses": [empty]}, 0)
    with pytest.raises(MISFITS):
        encoder_of("geometry_msgs/msg/Twist")({"linear": empty}, 0)


def test_elements_that_say_nothing_are_encoded_as_those_that_say_their_defaults():
    for name in NAMES:
        for field in DEFINITIONS.get(name).fields:
            kind = field.type
            if kind.is_primitive or not kind.is_sequence or kind.bound is not None:
                continue
            encode, spelt = encoder_of(name), default_json(kind.base)
            for count in range(1, 4):
                for text in ("", "x", "xy", "xyz"):
                    first = {"frame_id": text} if kind.base == "std_msgs/msg/Header" else {}
                    empties = encode({field.name: [first] + [{}] * count}, 0)
                    assert empties == encode({field.name: [first] + [spelt] * count}, 0)


def default_json(name):
    """Return a message with each of its fields said."""
    values = compile_decoder(DEFINITIONS.get(name), DEFINITIONS)(
        serialize_message(ros_class(name)())
    )
    return json.loads(dumps(values))


def test_fields_that_are_left_out_count_for_the_bound():
    encode = encoder_of("visualization_msgs/msg/MarkerArray")
    fields = count_fields(flatten(DEFINITIONS.get("visualization_msgs/msg/Marker"), DEFINITIONS))
    fitting = 60_000 // fields
    assert len(encode({"markers": [{"id": 1}] * fitting}, 0)) > 200 * fitting
    with pytest.raises(TooManyFieldsError, match="over 60000 values"):
        encode({"markers": [{"id": 1}] * (fitting + 1)}, 0)


def test_a_string_counts_as_three_fields_and_an_array_as_eight():
    for name, fields in {
        "geometry_msgs/msg/Point": 3,
        STRING: 3,
        "sensor_msgs/msg/LaserScan": 2 + 3 + 7 + 8 + 8,
        "nav_msgs/msg/Path": 2 + 3 + 8,
        "test_msgs/msg/Arrays": 27 + 5 * (8 + 3),
    }.items():
        assert count_fields(flatten(DEFINITIONS.get(name), DEFINITIONS)) == fields


def test_the_bound_on_fields_holds_for_nested_arrays_together():
    encode = encoder_of("visualization_msgs/msg/MarkerArray")
    points = [{"x": 1}] * (60_000 // 6)
    assert encode({"markers": [{"points": points}]}, 0)
    with pytest.raises(TooManyFieldsError):
        encode({"markers": [{"points": points}] * 3}, 0)


def test_a_message_whose_cdr_would_be_longer_than_16_mib_is_refused(tmp_path):
    share = tmp_path / "share" / "odd_msgs" / "msg"
    share.mkdir(parents=True)
    (share / "Item.msg").write_text("float64[1024] values\nint32 id\nint32 more\n")
    (share / "Items.msg").write_text("Item[] items\n")
    definitions = InstalledDefinitions([tmp_path])
    encode = compile_encoder(definitions.get("odd_msgs/msg/Items"), definitions)
    fitting = 16 * 1024**2 // (8 * 1024 + 8)
    for element in ({}, {"id": 1}):
        assert len(encode({"items": [element] * fitting}, 0)) <= 16 * 1024**2
        with pytest.raises(TooManyFieldsError, match="or 16777216 bytes"):
            encode({"items": [element] * (fitting + 2)}, 0)


def test_the_elements_of_an_array_may_have_a_field_of_any_name(tmp_path):
    share = tmp_path / "share" / "odd_msgs" / "msg"
    share.mkdir(parents=True)
    (share / "Item.msg").write_text("int32 item\nint32 copy\nint32 data\nint32 size\nint32 from\n")
    (share / "Items.msg").write_text("Item[] items\nItem[2] item\nstring[] data\nint32 length\n")
    definitions = InstalledDefinitions([tmp_path])
    definition = definitions.get("odd_msgs/msg/Items")
    for seed in range(5):
        values = RandomMessages(definitions, seed).message(definition.name)
        cdr = compile_encoder(definition, definitions)(to_json(values), 0)
        assert cdr == Writer(definitions).message(definition, values)
        assert compile_decoder(definition, definitions)(cdr) == to_json(values)


def test_defaults_that_no_literal_can_write_are_encoded(tmp_path):
    share = tmp_path / "share" / "odd_msgs" / "msg"
    share.mkdir(parents=True)
    (share / "Odd.msg").write_text("float64 a nan\nfloat32 b inf\nfloat64[2] c [-inf, nan]\n")
    definitions = InstalledDefinitions([tmp_path])
    cdr = compile_encoder(definitions.get("odd_msgs/msg/Odd"), definitions)({}, 0)
    a, b, c, d = struct.unpack("<4xdf4x2d", cdr)
    assert math.isnan(a)
    assert (b, c) == (math.inf, -math.inf)
    assert math.isnan(d)


class RandomTypes:
    """Makes up message types: fields of any primitive, arrays of all kinds, nested."""

    def __init__(self, folder, seed):
        self._share = folder / "share" / "odd_msgs" / "msg"
        self._share.mkdir(parents=True)
        self._random = random.Random(seed)
        self._definitions = InstalledDefinitions([folder])
        self.names = ["odd_msgs/msg/Empty"]
        (self._share / "Empty.msg").write_text("")

    def add(self):
        choose = self._random.choice
        lines = []
        for number in range(self._random.randint(1, 5)):
            base = choose([*sorted(PRIMITIVES), *self.names, "float64", "uint8"])
            lines.append(f"{base}{choose(['', '', '', '[]', '[2]', '[<=3]', '[30]'])} f{number}\n")
        name = f"T{len(self.names)}"
        (self._share / f"{name}.msg").write_text("".join(lines))
        self.names.append(f"odd_msgs/msg/{name}")
        return self._definitions.get(self.names[-1]), self._definitions


@pytest.mark.parametrize("seed", range(20))
def test_any_layout_is_encoded_and_decoded_as_the_reference_writes_it(tmp_path, seed):
    types = RandomTypes(tmp_path, seed)
    for _ in range(6):
        definition, definitions = types.add()
        encode = compile_encoder(definition, definitions)
        decode = compile_decoder(definition, definitions)
        for sample in range(3):
            values = RandomMessages(definitions, sample, longest=2).message(definition.name)
            cdr = Writer(definitions).message(definition, values)
            assert encode(to_json(values), 0) == cdr
            assert normalized(decode(cdr)) == to_json(values)
            big_endian = Writer(definitions, ">", padding=0xA5).message(definition, values)
            assert normalized(decode(big_endian)) == to_json(values)
        for field in definition.fields:
            decode = compile_decoder(definition, definitions, (field.name,))
            assert normalized(decode(cdr)) == {field.name: to_json(values[field.name])}


def test_elements_with_padding_between_them_are_read_one_by_one(tmp_path):
    share = tmp_path / "share" / "odd_msgs" / "msg"
    share.mkdir(parents=True)
    (share / "Item.msg").write_text("float64 value\nuint8 flag\n")
    (share / "Items.msg").write_text("Item[] items\n")
    definitions = InstalledDefinitions([tmp_path])
    definition = definitions.get("odd_msgs/msg/Items")
    values = {"items": [{"value": float(number), "flag": number} for number in range(4)]}
    cdr = Writer(definitions).message(definition, values)
    assert compile_decoder(definition, definitions)(cdr) == values


def test_an_array_holds_at_most_20_000_texts():
    names = [""] * 20_000
    encode = encoder_of("sensor_msgs/msg/JointState")
    assert encode({"name": names}, 0)
    with pytest.raises(TooManyFieldsError, match="send fewer elements at once"):
        encode({"name": [*names, ""]}, 0)
