# SPDX-License-Identifier: Apache-2.0
import linecache
import math
import random
import struct

import pytest
from rclpy.serialization import deserialize_message

from gateway.codec.cdr import compile_decoder, compile_encoder
from gateway.codec.errors import CodecError
from schemas.definition import PRIMITIVES
from schemas.installed import InstalledDefinitions
from tests.codec.cdr.reference import Writer
from tests.messages import RandomMessages, from_ros, normalized, ros_class, to_json, to_objects

DEFINITIONS = InstalledDefinitions()
NAMES = DEFINITIONS.names()

STRING = "std_msgs/msg/String"
POSE = "geometry_msgs/msg/PoseWithCovariance"


def encoder_of(name):
    return compile_encoder(DEFINITIONS.get(name), DEFINITIONS)


def encoded(name, **changes):
    """Encode a message with the values that *changes* does not state made up."""
    values = RandomMessages(DEFINITIONS, 0, longest=2).message(name)
    return encoder_of(name)(to_objects(values | changes))


def samples(name):
    for seed in range(3):
        yield RandomMessages(DEFINITIONS, seed).message(name)


@pytest.mark.parametrize("name", NAMES)
def test_messages_are_encoded_as_the_reference_writes_them(name):
    encode = encoder_of(name)
    writer = Writer(DEFINITIONS)
    for values in samples(name):
        assert encode(to_objects(values)) == writer.message(DEFINITIONS.get(name), values)


@pytest.mark.parametrize("name", NAMES)
def test_rclpy_reads_what_is_encoded(name):
    encode = encoder_of(name)
    for values in samples(name):
        message = deserialize_message(encode(to_objects(values)), ros_class(name))
        assert from_ros(DEFINITIONS.get(name), DEFINITIONS, message) == values


@pytest.mark.parametrize("name", [name for name in NAMES if name != "test_msgs/msg/WStrings"])
def test_rosbags_reads_what_is_encoded(name, rosbags_store):
    encode = encoder_of(name)
    for values in samples(name):
        message = rosbags_store.deserialize_cdr(encode(to_objects(values)), name)
        assert from_ros(DEFINITIONS.get(name), DEFINITIONS, message) == values


def test_none_is_nan_for_a_float():
    encode = encoder_of("geometry_msgs/msg/Vector3")
    message = to_objects({"x": 1.5, "y": None, "z": -2.0})
    x, y, z = struct.unpack("<4x3d", encode(message))
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


@pytest.mark.parametrize("value", [None, "1", 2**64, -(2**63) - 1])
def test_a_value_without_encoding_raises_codec_error(value):
    with pytest.raises(CodecError, match=r"^std_msgs/msg/Int64 cannot be encoded: "):
        encoded("std_msgs/msg/Int64", data=value)


def test_a_float_beyond_float32_raises_codec_error():
    with pytest.raises(CodecError, match=r"^std_msgs/msg/Float32 cannot be encoded: "):
        encoded("std_msgs/msg/Float32", data=1e39)


def test_a_lone_surrogate_raises_codec_error():
    with pytest.raises(CodecError, match="surrogates not allowed"):
        encoded(STRING, data="\ud83d")


@pytest.mark.parametrize("length", [35, 37])
def test_a_fixed_array_of_another_length_raises_codec_error(length):
    with pytest.raises(CodecError, match=rf"^covariance has {length} elements, expected 36$"):
        encoded(POSE, covariance=[0.0] * length)


@pytest.mark.parametrize(
    ("name", "field", "value", "text"),
    [
        ("Arrays", "uint8_values", b"12", "has 2 elements, expected 3"),
        ("Arrays", "int16_values", [1] * 4, "has 4 elements, expected 3"),
        ("Arrays", "string_values", ["a"], "has 1 elements, expected 3"),
        ("Arrays", "basic_types_values", [], "has 0 elements, expected 3"),
        ("BoundedSequences", "int8_values", [1] * 4, "has 4 elements, expected at most 3"),
        ("BoundedSequences", "uint8_values", b"1234", "has 4 elements, expected at most 3"),
        ("BoundedSequences", "string_values", [""] * 4, "has 4 elements, expected at most 3"),
        ("Strings", "bounded_string_value", "ü" * 12, "has 24 elements, expected at most 22"),
    ],
)
def test_a_wrong_length_raises_codec_error(name, field, value, text):
    with pytest.raises(CodecError, match=f"^{field} {text}$"):
        encoded(f"test_msgs/msg/{name}", **{field: value})


def test_the_elements_of_an_array_may_have_a_field_of_any_name(tmp_path):
    share = tmp_path / "share" / "odd_msgs" / "msg"
    share.mkdir(parents=True)
    (share / "Item.msg").write_text("int32 item\nint32 copy\nint32 data\nint32 size\nint32 from\n")
    (share / "Items.msg").write_text("Item[] items\nItem[2] item\nstring[] data\nint32 length\n")
    definitions = InstalledDefinitions([tmp_path])
    definition = definitions.get("odd_msgs/msg/Items")
    for seed in range(5):
        values = RandomMessages(definitions, seed).message(definition.name)
        cdr = compile_encoder(definition, definitions)(to_objects(values))
        assert cdr == Writer(definitions).message(definition, values)
        assert compile_decoder(definition, definitions)(cdr) == to_json(values)


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
            assert encode(to_objects(values)) == cdr
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


def test_tracebacks_show_the_generated_source():
    encode = encoder_of(STRING)
    lines = linecache.getlines(encode.__code__.co_filename)
    assert "def encode(message):\n" in lines
