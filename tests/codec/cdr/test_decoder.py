# SPDX-License-Identifier: Apache-2.0
import gc
import linecache
import math
import random
import struct
import traceback
import tracemalloc

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rclpy.serialization import serialize_message

from gateway.codec.cdr import compile_decoder, compile_encoder
from gateway.codec.error_text import CodecError, FieldError
from gateway.codec.json import dumps
from schemas.definition_text import parse_definition
from schemas.installed import InstalledDefinitions
from tests.codec.cdr.reference import Writer
from tests.messages import RandomMessages, normalized, to_json, to_ros

DEFINITIONS = InstalledDefinitions()
NAMES = DEFINITIONS.names()
SAMPLES = range(3)

TWIST = "geometry_msgs/msg/Twist"
STRING = "std_msgs/msg/String"
ODOMETRY = "nav_msgs/msg/Odometry"
MARKERS = "visualization_msgs/msg/MarkerArray"


def decoder_of(name, fields=None, octets="base64"):
    return compile_decoder(DEFINITIONS.get(name), DEFINITIONS, fields, octets=octets)


def cdr_of(name, values, order="<", padding=0):
    return Writer(DEFINITIONS, order, padding).message(DEFINITIONS.get(name), values)


def samples(name, longest=4):
    for seed in SAMPLES:
        yield RandomMessages(DEFINITIONS, seed, longest).message(name)


@pytest.mark.parametrize("name", NAMES)
def test_messages_of_rclpy_are_decoded_to_the_same_values(name):
    definition = DEFINITIONS.get(name)
    decode = decoder_of(name)
    for values in samples(name):
        cdr = serialize_message(to_ros(definition, DEFINITIONS, values))
        decoded = decode(cdr)
        assert normalized(decoded) == to_json(values)
        assert list(decoded) == [field.name for field in definition.fields]


@pytest.mark.parametrize("name", NAMES)
def test_padding_byte_order_and_whose_the_memory_is_do_not_matter(name):
    decode = decoder_of(name)
    for values in samples(name):
        for order in "<>":
            cdr = cdr_of(name, values, order, padding=0xA5)
            assert normalized(decode(cdr)) == to_json(values)
            assert dumps(decode(memoryview(cdr))) == dumps(decode(cdr))


@pytest.mark.parametrize("name", NAMES)
def test_a_truncated_message_raises_codec_error_with_its_offset(name):
    decode = decoder_of(name)
    for values in samples(name, longest=1):
        cdr = cdr_of(name, values)
        lengths = range(len(cdr))
        if len(cdr) > 500:
            lengths = random.Random(0).sample(lengths, 500)
        for length in lengths:
            with pytest.raises(CodecError) as caught:
                decode(cdr[:length])
            assert caught.value.offset <= length + 4  # padding may also be missing


@pytest.mark.parametrize("name", NAMES)
def test_a_message_with_octets_flipped_is_decoded_or_raises_codec_error(name):
    decode = decoder_of(name)
    chance = random.Random(name)
    for values in samples(name, longest=2):
        for order in "<>":
            cdr = cdr_of(name, values, order)
            for _ in range(30):
                broken = bytearray(cdr)
                for _ in range(chance.randint(1, 4)):
                    broken[chance.randrange(4, len(broken))] = chance.choice([0, 1, 127, 255])
                assert decode_or_codec_error(decode, bytes(broken))


FUZZED = [decoder_of(name) for name in (ODOMETRY, MARKERS, "test_msgs/msg/MultiNested")]


@given(st.binary(max_size=300), st.sampled_from([b"\0\1\0\0", b"\0\0\0\0", b""]))
def test_any_octets_are_decoded_or_raise_codec_error(octets, header):
    for decode in FUZZED:
        assert decode_or_codec_error(decode, header + octets)


def decode_or_codec_error(decode, cdr):
    try:
        decoded = decode(cdr)
    except CodecError as error:
        return error.offset is not None
    return bool(dumps(decoded))


@pytest.mark.parametrize(
    "name",
    [
        STRING,
        MARKERS,
        "geometry_msgs/msg/PolygonStamped",
        "sensor_msgs/msg/Image",
        "sensor_msgs/msg/LaserScan",
        "test_msgs/msg/UnboundedSequences",
        "test_msgs/msg/WStrings",
    ],
)
@pytest.mark.parametrize("count", [2**16, 2**31, 2**32 - 1])
def test_a_hostile_count_allocates_nothing(name, count):
    decode = decoder_of(name)
    empty = RandomMessages(DEFINITIONS, 0, longest=0).message(name)
    cdr = cdr_of(name, empty)
    decode(cdr)
    tracemalloc.start()
    try:
        for offset in range(4, len(cdr) - 3, 4):
            broken = cdr[:offset] + struct.pack("<I", count) + cdr[offset + 4 :]
            # errors of earlier rounds wait for the garbage collector
            before, _ = tracemalloc.get_traced_memory()
            tracemalloc.reset_peak()
            assert decode_or_codec_error(decode, broken)
            _, peak = tracemalloc.get_traced_memory()
            assert peak - before < 450_000  # the shortest list of so many takes 524,288
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(("count", "kind"), [(24, tuple), (25, np.ndarray)])
def test_numbers_are_a_view_where_there_are_more_than_24(count, kind):
    name = "sensor_msgs/msg/JointState"
    values = RandomMessages(DEFINITIONS, 0, longest=0).message(name) | {"position": [0.5] * count}
    assert type(decoder_of(name)(cdr_of(name, values))["position"]) is kind


def test_a_short_message_raises_codec_error_with_its_offset():
    with pytest.raises(CodecError, match=r"^need 52 bytes at offset 0, message has 28$") as caught:
        decoder_of(TWIST)(b"\0\1\0\0" + bytes(24))
    assert caught.value.offset == 0


def test_a_short_string_raises_codec_error_with_its_offset():
    cdr = b"\0\1\0\0" + struct.pack("<I", 9) + b"four"
    with pytest.raises(CodecError, match=r"^need 9 bytes at offset 8, message has 12$") as caught:
        decoder_of(STRING)(cdr)
    assert caught.value.offset == 8


def test_a_count_beyond_what_is_left_raises_codec_error_before_the_first_element():
    cdr = cdr_of(MARKERS, RandomMessages(DEFINITIONS, 0).message(MARKERS))
    broken = cdr[:4] + struct.pack("<I", 2**20) + cdr[8:]
    with pytest.raises(CodecError, match=r"^need \d{9} bytes at offset 8, message has \d+$"):
        decoder_of(MARKERS)(broken)


def test_a_count_of_strings_is_checked_before_the_first_of_them_by_what_each_takes_at_least():
    definition = parse_definition("some_msgs/msg/Names", "string[] names")
    decode = compile_decoder(definition, DEFINITIONS)
    with pytest.raises(CodecError, match=r"^need 4000 bytes at offset 8, message has 8$"):
        decode(b"\0\1\0\0" + struct.pack("<I", 1000))


@pytest.mark.parametrize(
    "header", [b"\0\2", b"\0\3", b"\0\6", b"\0\7", b"\1\0", b"\1\1", b"\xff\xff"]
)
def test_an_encapsulation_other_than_plain_cdr_raises_codec_error(header):
    with pytest.raises(CodecError, match=f"encapsulation 0x{header.hex()} is not plain CDR"):
        decoder_of(STRING)(header + b"\0\0" + bytes(12))


def test_the_options_of_the_encapsulation_are_ignored():
    cdr = bytearray(cdr_of(STRING, {"data": "hi"}))
    cdr[2:4] = b"\xab\x03"
    assert decoder_of(STRING)(bytes(cdr)) == {"data": "hi"}


def test_octets_after_the_message_are_ignored():
    assert decoder_of(STRING)(cdr_of(STRING, {"data": "hi"}) + bytes(3)) == {"data": "hi"}


@pytest.mark.parametrize(
    ("octets", "text"),
    [
        (b"", ""),  # no terminator to count: not by the book, but seen
        (b"\0", ""),
        (b"abc", "abc"),
        (b"a\0bc\0", "a"),
        (b"\xe9bc\0", "\ufffdbc"),
        (b"\xf0\x9f\xa4\x96\0", "\U0001f916"),
        (b"\xed\xa0\x80\0", "\ufffd\ufffd\ufffd"),
    ],
)
def test_a_string_is_read_as_rclpy_reads_it(octets, text):
    from rclpy.serialization import deserialize_message
    from std_msgs.msg import String

    cdr = b"\0\1\0\0" + struct.pack("<I", len(octets)) + octets
    assert decoder_of(STRING)(cdr) == {"data": text}
    assert deserialize_message(cdr, String).data == text


def test_a_lone_surrogate_in_a_wide_string_is_replaced():
    values = RandomMessages(DEFINITIONS, 0, longest=0).message("test_msgs/msg/WStrings")
    cdr = cdr_of("test_msgs/msg/WStrings", values | {"wstring_value": "a"})
    broken = cdr[:8] + struct.pack("<I", 0xD83D) + cdr[12:]
    assert decoder_of("test_msgs/msg/WStrings")(broken)["wstring_value"] == "\ufffd"


def test_non_finite_floats_are_kept_and_written_as_null():
    plain = RandomMessages(DEFINITIONS, 0).message("sensor_msgs/msg/LaserScan")
    plain["angle_min"] = math.nan
    plain["ranges"] = [math.inf, -math.inf, math.nan] * 20
    plain["intensities"] = [math.nan]
    decoded = decoder_of("sensor_msgs/msg/LaserScan")(cdr_of("sensor_msgs/msg/LaserScan", plain))
    assert math.isnan(decoded["angle_min"])
    assert math.isinf(decoded["ranges"][0])
    text = dumps(decoded)
    assert b'"angle_min":null' in text
    assert b'"ranges":[null,null,null,' in text
    assert b'"intensities":[null]' in text


def test_integers_of_64_bits_keep_every_digit():
    extremes = [2**64 - 1, 0, 2**63]
    plain = RandomMessages(DEFINITIONS, 0).message("test_msgs/msg/UnboundedSequences")
    decode = decoder_of("test_msgs/msg/UnboundedSequences", ("uint64_values",))
    for repeat in (1, 20):
        values = plain | {"uint64_values": extremes * repeat}
        text = dumps(decode(cdr_of("test_msgs/msg/UnboundedSequences", values)))
        assert b"[18446744073709551615,0,9223372036854775808" in text


def test_any_octet_but_zero_is_true():
    values = {"data": True}
    cdr = cdr_of("std_msgs/msg/Bool", values)[:-1] + b"\x07"
    assert decoder_of("std_msgs/msg/Bool")(cdr) == {"data": True}


@pytest.mark.parametrize("count", [3, 60])
def test_bools_in_a_sequence_are_bools_whatever_their_octets(count):
    name = "test_msgs/msg/UnboundedSequences"
    values = RandomMessages(DEFINITIONS, 0).message(name) | {
        "bool_values": [True, False, True] * count
    }
    cdr = cdr_of(name, values)
    broken = cdr[:8] + bytes([7, 0, 255] * count) + cdr[8 + 3 * count :]
    decoded = decoder_of(name, ("bool_values",))(broken)
    assert dumps(decoded).startswith(b'{"bool_values":[true,false,true')
    assert bytes(decoded["bool_values"]) == bytes([1, 0, 1] * count)


@pytest.mark.parametrize(
    ("name", "field", "value", "text"),
    [
        ("BoundedSequences", "bool_values", [True] * 4, "has 4 elements, at most 3 are allowed"),
        ("BoundedSequences", "string_values", [""] * 4, "has 4 elements, at most 3 are allowed"),
        ("Strings", "bounded_string_value", "x" * 23, "has 23 elements, at most 22 are allowed"),
    ],
)
def test_more_than_a_bound_allows_raises_codec_error(name, field, value, text):
    name = f"test_msgs/msg/{name}"
    values = RandomMessages(DEFINITIONS, 0).message(name) | {field: value}
    with pytest.raises(CodecError, match=f"^{field} {text}$"):
        decoder_of(name)(cdr_of(name, values))


def test_raw_octets_are_a_view_on_the_message():
    name = "sensor_msgs/msg/CompressedImage"
    values = RandomMessages(DEFINITIONS, 0).message(name) | {"data": b"\xff\xd8jpeg"}
    cdr = cdr_of(name, values)
    data = decoder_of(name, octets="raw")(cdr)["data"]
    assert isinstance(data, memoryview)
    assert data.obj is cdr
    assert data == b"\xff\xd8jpeg"


def test_raw_octets_of_a_fixed_array_are_a_view():
    values = {"uuid": bytes(range(16))}
    name = "unique_identifier_msgs/msg/UUID"
    assert decoder_of(name, octets="raw")(cdr_of(name, values)) == {"uuid": bytes(range(16))}


def picked(value, fields):
    """Pick dotted paths out of a message, through lists."""
    if isinstance(value, list):
        return [picked(item, fields) for item in value]
    result = {}
    for name in value:
        below = [path.partition(".")[2] for path in fields if path.partition(".")[0] == name]
        if below:
            result[name] = value[name] if "" in below else picked(value[name], below)
    return result


def test_the_reference_picks_fields():
    message = {"a": [{"b": 1, "c": 2}, {"b": 3, "c": 4}], "d": {"e": 5, "f": 6}, "g": 7}
    expected = {"a": [{"b": 1}, {"b": 3}], "d": {"e": 5, "f": 6}}
    assert picked(message, ["d", "d.e", "a.b"]) == expected


@pytest.mark.parametrize(
    ("name", "fields"),
    [
        (ODOMETRY, ("pose.pose.position",)),
        (ODOMETRY, ("header.stamp", "child_frame_id")),
        (ODOMETRY, ("twist.covariance", "twist.twist.linear.y")),
        (ODOMETRY, ("pose", "pose.pose.position.x", "pose.covariance")),
        (ODOMETRY, ("pose.covariance", "pose")),
        (MARKERS, ("markers.ns", "markers.points.y")),
        (MARKERS, ("markers.text", "markers.mesh_file.data", "markers.colors")),
        ("test_msgs/msg/WStrings", ("unbounded_sequence_of_wstrings",)),
        (
            "test_msgs/msg/MultiNested",
            ("bounded_sequence_of_arrays.defaults_values.bool_value",),
        ),
    ],
)
def test_fields_select_what_is_decoded(name, fields):
    decode = decoder_of(name, fields)
    for values in samples(name):
        for order in "<>":
            decoded = decode(cdr_of(name, values, order, padding=0xA5))
            assert normalized(decoded) == to_json(picked(values, fields))


@pytest.mark.parametrize("name", NAMES)
def test_each_field_alone_is_decoded_as_in_the_whole(name):
    for field in DEFINITIONS.get(name).fields:
        decode = decoder_of(name, (field.name,))
        for values in samples(name):
            decoded = decode(cdr_of(name, values, padding=0xA5))
            assert normalized(decoded) == {field.name: to_json(values[field.name])}


def test_nothing_is_read_after_the_last_wanted_field():
    values = RandomMessages(DEFINITIONS, 0).message(ODOMETRY)
    decode = decoder_of(ODOMETRY, ("header.stamp",))
    assert decode(cdr_of(ODOMETRY, values)[:12]) == {"header": {"stamp": values["header"]["stamp"]}}


@pytest.mark.parametrize(
    ("path", "reason"),
    [
        ("poze", "nav_msgs/msg/Odometry has header, child_frame_id, pose, twist"),
        ("pose.x", "geometry_msgs/msg/PoseWithCovariance has pose, covariance"),
        ("child_frame_id.x", "child_frame_id is string, it has no fields"),
        ("header..sec", "std_msgs/msg/Header has stamp, frame_id"),
        ("", "nav_msgs/msg/Odometry has header, child_frame_id, pose, twist"),
    ],
)
def test_an_unknown_path_raises_field_error_naming_the_fields(path, reason):
    with pytest.raises(FieldError) as caught:
        decoder_of(ODOMETRY, ("header", path))
    assert str(caught.value) == f"unknown field {path}: {reason}"


def test_tracebacks_show_the_generated_source():
    with pytest.raises(CodecError) as caught:
        decoder_of(STRING)(b"\0\1")
    lines = "".join(traceback.format_exception(caught.value))
    assert "<CDR decoder of std_msgs/msg/String>" in lines
    assert "raise truncated(offset, length, size)" in lines


def test_the_source_goes_with_its_decoder():
    decode = decoder_of(ODOMETRY, ("twist", "header.stamp.sec"))
    filename = decode.__code__.co_filename
    assert filename in linecache.cache
    del decode
    gc.collect()
    assert filename not in linecache.cache


def test_the_source_is_the_same_each_time():
    first, second = decoder_of(MARKERS), decoder_of(MARKERS)
    assert first.__code__ == second.__code__


def test_a_char_of_idl_is_an_octet(tmp_path):
    folder = tmp_path / "share" / "p" / "msg"
    folder.mkdir(parents=True)
    (folder / "A.idl").write_text(
        "module p { module msg { struct A { char x; sequence<char> xs; char ys[3]; }; }; };"
    )
    definitions = InstalledDefinitions([tmp_path])
    definition = definitions.get("p/msg/A")
    # serialized by rclpy: A(x="R", xs=["2", "D"], ys=["a", "b", "c"]), with 0 as padding
    cdr = bytes.fromhex("0001000052000000020000003244616263")
    values = {"x": 82, "xs": "MkQ=", "ys": "YWJj"}
    assert normalized(compile_decoder(definition, definitions)(cdr)) == values
    assert compile_encoder(definition, definitions)(values, 0) == cdr
