# SPDX-License-Identifier: Apache-2.0
"""Writing in slices and writing in one call give the same bytes."""

import struct
from collections.abc import Generator
from typing import Any

import numpy as np
import pytest

from gateway.codec.error_text import CodecError
from gateway.codec.json_slices import SLICE_NUMBERS, SLICE_OCTETS, json_slices
from gateway.codec.nonfinite import NonFinite, writer
from gateway.codec.types import Types
from schemas.folders import SHIPPED
from schemas.installed import InstalledDefinitions

TYPES = Types(InstalledDefinitions(folders=[SHIPPED]))
MANY = 3 * SLICE_NUMBERS + 7
POINT = {"x": 0.1, "y": -2.0, "z": 1e300}

GIANTS: dict[str, tuple[str, dict[str, Any]]] = {
    "map": ("nav_msgs/msg/OccupancyGrid", {"data": [-1, 0, 100] * SLICE_NUMBERS}),
    "empty map": ("nav_msgs/msg/OccupancyGrid", {}),
    "cloud": (
        "sensor_msgs/msg/PointCloud2",
        {"fields": [{"name": "x", "count": 3}, {"name": "y"}], "data": [1, 2, 255] * 70_000},
    ),
    "empty cloud": ("sensor_msgs/msg/PointCloud2", {}),
    "scan": ("sensor_msgs/msg/LaserScan", {"ranges": [0.1] * MANY, "intensities": [1.0]}),
    "numbers": (
        "std_msgs/msg/Float64MultiArray",
        {"layout": {"dim": [{"label": "ü" * 40}]}, "data": [1.5, "NaN", "-Infinity"] * MANY},
    ),
    "text": ("std_msgs/msg/String", {"data": 'größe "\\\n\U0001f916' * SLICE_NUMBERS}),
    "marker": (
        "visualization_msgs/msg/Marker",
        {"points": [POINT] * 300, "colors": [{"r": 0.1, "a": "Infinity"}] * 300},
    ),
    "markers": (
        "visualization_msgs/msg/MarkerArray",
        {"markers": [{"ns": "a", "points": [POINT] * 70}, {}, {"text": "null"}] * 60},
    ),
    "path": (
        "nav_msgs/msg/Path",
        {"poses": [{"header": {"frame_id": "map"}, "pose": {"position": POINT}}] * 200},
    ),
    "names": ("sensor_msgs/msg/JointState", {"name": ["a", "", "ü"] * 100, "position": [1.0]}),
    "transforms": ("tf2_msgs/msg/TFMessage", {"transforms": [{"child_frame_id": "x"}] * 64}),
}


def cdr_of(name: str) -> tuple[Any, bytes]:
    type_name, values = GIANTS[name]
    message_type = TYPES.get(type_name)
    return message_type, message_type.encode(values, now_ns=0)


def big_endian(numbers: list[float]) -> bytes:
    """Return a Float64MultiArray as a PowerPC would send it."""
    return struct.pack(f">HHIII4x{len(numbers)}d", 0, 0, 0, 0, len(numbers), *numbers)


def run(steps: Generator[bytes, None, Any]) -> tuple[int, Any]:
    """Return the number of pauses, and what a generator returns."""
    pauses = 0
    while True:
        try:
            assert next(steps) == b""
        except StopIteration as end:
            return pauses, end.value
        pauses += 1


def in_slices(message_type: Any, cdr: bytes, form: NonFinite, fields: Any = None) -> list[bytes]:
    write = writer(form)
    # as rcl has handed it over
    _, value = run(message_type.sliced_decoder(fields)(memoryview(cdr), write))
    return list(json_slices(value, write))


@pytest.mark.parametrize("form", ["null", "string", "token"])
@pytest.mark.parametrize("name", GIANTS)
def test_slices_are_the_json_that_one_call_writes(name: str, form: NonFinite):
    message_type, cdr = cdr_of(name)
    assert b"".join(in_slices(message_type, cdr, form)) == writer(form)(message_type.decode(cdr))


@pytest.mark.parametrize("form", ["null", "string"])
def test_slices_have_the_fields_that_were_asked_for(form: NonFinite):
    for name, fields in (("numbers", ("layout.dim",)), ("markers", ("markers.points.x",))):
        message_type, cdr = cdr_of(name)
        whole = writer(form)(message_type.decoder(fields)(cdr))
        assert b"".join(in_slices(message_type, cdr, form, fields)) == whole


def test_the_other_byte_order_is_read_in_slices_too():
    message_type = TYPES.get("std_msgs/msg/Float64MultiArray")
    cdr = big_endian([1.5, -2.0] * SLICE_NUMBERS)
    assert b"".join(in_slices(message_type, cdr, "null")) == writer("null")(
        message_type.decode(cdr)
    )


def test_booleans_are_true_whatever_their_octet():
    value = np.array([0, 1, 255] * SLICE_NUMBERS, np.uint8) != 0
    write = writer("null")
    assert b"".join(json_slices({"data": value}, write)) == write({"data": value})


@pytest.mark.parametrize(
    ("name", "most"),
    [("map", SLICE_NUMBERS), ("numbers", SLICE_NUMBERS), ("scan", SLICE_NUMBERS), ("marker", 64)],
)
def test_no_more_numbers_or_elements_are_written_at_once_than_a_slice_has(name: str, most: int):
    message_type, cdr = cdr_of(name)
    written: list[int] = []
    dumps = writer("null")

    def write(value: Any) -> bytes:
        if isinstance(value, (np.ndarray, list)):
            written.append(len(value))
        return dumps(value)

    _, value = run(message_type.sliced_decoder()(cdr, write))
    list(json_slices(value, write))
    assert max(written) == most
    assert SLICE_NUMBERS == 8192


def test_no_more_octets_are_written_at_once_than_a_slice_has():
    sizes = [len(text) for text in json_slices({"data": memoryview(bytes(10**6))}, writer("null"))]
    assert max(sizes) == SLICE_OCTETS // 3 * 4


def test_a_long_text_is_written_in_slices():
    parts = list(json_slices("x" * MANY, writer("null")))
    assert max(map(len, parts)) == SLICE_NUMBERS


def test_elements_that_are_large_by_their_texts_do_not_share_a_slice():
    texts = ["x" * 16 * SLICE_NUMBERS] * 3
    parts = list(json_slices(texts, writer("null")))
    assert b"".join(parts) == writer("null")(texts)
    assert max(map(len, parts)) == SLICE_NUMBERS


def test_elements_share_a_slice_as_long_as_they_fit():
    texts = ["x" * 5 * SLICE_NUMBERS] * 6  # each takes as long as a third of the numbers
    parts = list(json_slices(texts, writer("null")))
    assert b"".join(parts) == writer("null")(texts)
    assert [part.count(b"x") // len(texts[0]) for part in parts] == [3, 3, 0]


@pytest.mark.parametrize("name", ["marker", "markers", "path", "names", "transforms"])
def test_decoding_many_elements_pauses_now_and_then(name: str):
    message_type, cdr = cdr_of(name)
    pauses, _ = run(message_type.sliced_decoder()(cdr, writer("null")))
    elements = max(len(value) for value in GIANTS[name][1].values() if isinstance(value, list))
    assert pauses > elements // 64


def test_skipping_many_elements_pauses_now_and_then():
    message_type, cdr = cdr_of("markers")
    sliced = TYPES.get("visualization_msgs/msg/MarkerArray").sliced_decoder(("markers.id",))
    pauses, value = run(sliced(cdr, writer("null")))
    assert b"".join(json_slices(value, writer("null"))) == writer("null")(
        message_type.decoder(("markers.id",))(cdr)
    )
    assert pauses > 180 // 64


def test_truncated_data_raises_codec_error_with_its_offset():
    message_type, cdr = cdr_of("path")
    with pytest.raises(CodecError) as sliced:
        run(message_type.sliced_decoder()(cdr[:-3], writer("null")))
    with pytest.raises(CodecError) as whole:
        message_type.decode(cdr[:-3])
    assert str(sliced.value) == str(whole.value)


def test_data_that_is_not_plain_cdr_raises_codec_error():
    message_type, cdr = cdr_of("path")
    with pytest.raises(CodecError, match="encapsulation 0x0007"):
        run(message_type.sliced_decoder()(b"\0\7" + cdr[2:], writer("null")))


@pytest.mark.parametrize("name", GIANTS)
def test_cbor_in_slices_is_that_of_one_call(name: str):
    message_type, cdr = cdr_of(name)
    _, parts = run(message_type.sliced_transcoder()(memoryview(cdr)))
    assert b"".join(parts) == message_type.transcoder()(cdr)


def test_cbor_in_slices_does_not_copy_large_arrays():
    message_type, cdr = cdr_of("map")
    _, parts = run(message_type.sliced_transcoder()(cdr))
    assert [len(part) for part in parts if isinstance(part, memoryview)] == [3 * SLICE_NUMBERS]


def test_cbor_of_many_elements_pauses_now_and_then():
    message_type, cdr = cdr_of("markers")
    pauses, _ = run(message_type.sliced_transcoder()(cdr))
    assert pauses > 60 * 2
