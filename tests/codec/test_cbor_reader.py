# SPDX-License-Identifier: Apache-2.0
import json
import math
import struct

import cbor2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gateway.codec.cbor_reader import MAX_SINGLE_ITEMS, CborError, is_cbor, loads
from gateway.codec.types import Types
from schemas.installed import InstalledDefinitions
from schemas.json_forms import NumberArray
from schemas.table import Table
from tests.messages import RandomMessages, to_json

DEFINITIONS = InstalledDefinitions()
TYPES = Types(DEFINITIONS)
VALUES = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**63), 2**64 - 1)
    | st.floats(allow_nan=False)
    | st.text()
    | st.binary(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
)
DTYPES = ["<u2", "<u4", "<u8", "<i1", "<i2", "<i4", "<i8", "<f4", "<f8"]
TAGS = dict(zip(DTYPES, [69, 70, 71, 72, 77, 78, 79, 85, 86], strict=True))  # RFC 8746, 2.1


def typed(array: np.ndarray) -> cbor2.CBORTag:
    return cbor2.CBORTag(TAGS[array.dtype.newbyteorder("<").str.replace("|", "<")], array.tobytes())


@given(VALUES, st.booleans())
def test_values_that_cbor2_writes_are_read(value, canonical):
    assert loads(cbor2.dumps(value, canonical=canonical)) == value


@given(VALUES)
def test_a_value_is_the_same_in_json_and_cbor(value):
    text = json.dumps(value, default=lambda octets: octets.hex())
    assert loads(cbor2.dumps(json.loads(text))) == json.loads(text)


@pytest.mark.parametrize("dtype", DTYPES)
def test_typed_arrays_become_numbers(dtype):
    numbers = np.array([0, 1, 100, 127], dtype)
    found = loads(cbor2.dumps({"a": typed(numbers), "b": typed(numbers[:0])}))
    assert found == {"a": [0, 1, 100, 127], "b": []}
    assert {type(each) for each in found["a"]} == {float if dtype[1] == "f" else int}


@pytest.mark.parametrize("tag", [64, 68])
def test_typed_arrays_of_uint8_become_bytes(tag):
    assert loads(cbor2.dumps(cbor2.CBORTag(tag, b"\1\2"))) == b"\1\2"


def test_floats_of_every_width_are_read():
    data = b"\x83\xf9\x3e\x00\xfa\x3f\xc0\x00\x00\xfb" + struct.pack(">d", 1.5)
    assert loads(data) == [1.5, 1.5, 1.5]
    assert math.isnan(loads(b"\xf9\x7e\x00"))


def test_undefined_is_null():
    assert loads(b"\xf7") is None


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", "it ends where an item is missing, at byte 0"),
        (b"\xa1\x61a", "it ends where an item is missing, at byte 3"),
        (b"\x19\x01", "it ends within a number, at byte 0"),
        (b"\xa1\x61a\x43ab", "it ends within a string of 3 bytes, at byte 3"),
        (b"\x5b" + b"\xff" * 8, "it ends within a string of 18446744073709551615 bytes"),
        (b"\x9b" + b"\xff" * 8, "it ends where an item is missing"),
        (b"\xbb" + b"\xff" * 8, "it ends where an item is missing"),
        (b"\x01\x01", "it goes on behind its end, at byte 1"),
        (b"\x62\xff\xff", "text that is not UTF-8, at byte 0"),
        (b"\x63\xed\xa0\x80", "text that is not UTF-8"),
        (b"\xbf\xff", "an item of indefinite length, or of a reserved kind"),
        (b"\x5f\x41a\xff", "an item of indefinite length"),
        (b"\xff", "a simple value other than false, true, null and undefined"),
        (b"\xe0", "a simple value other than"),
        (b"\x1c", "of a reserved kind"),
        (b"\xa1\x01\x01", "a key that is not text, at byte 1"),
        (b"\xa2\x61a\x01\x61a\x02", "a key twice in one map, at byte 4"),
        (b"\x3b\x80" + b"\0" * 7, "an integer below -2**63"),
        (cbor2.dumps(cbor2.CBORTag(0, "2026-11-23T00:00:00Z")), "tag 0, known are those of typed"),
        (cbor2.dumps(2**64), "tag 2, known are"),
        (cbor2.dumps(cbor2.CBORTag(65, b"\0\1")), "tag 65, known are"),
        (b"\xd8\x55\x44\0\0\0", "it ends within a string of 4 bytes"),
        (b"\xd8\x55\x43\0\0\0", "a typed array of 3 bytes for numbers of 4"),
        (b"\xd8\x55\x80", "a typed array that is not a byte string"),
        (b"\xd8\x55", "a typed array that is not a byte string"),
        (b"\xd8\x55" * 2000 + b"\x40", "a typed array that is not a byte string"),
    ],
)
def test_unsupported_items_are_refused_with_their_place(data, words):
    with pytest.raises(CborError) as caught:
        loads(data)
    assert words in str(caught.value)
    assert str(caught.value).startswith("frame is not CBOR that can be taken: ")


def test_maps_and_arrays_nest_as_deep_as_json():
    deep = b"\x81" * 5 + b"\x01"
    assert loads(deep, max_depth=5) == [[[[[1]]]]]
    for data in (b"\x81" + deep, b"\x81" * 100_000, b"\xa1\x61a" * 100_000):
        with pytest.raises(CborError, match="frame nests deeper than 5 levels"):
            loads(data, max_depth=5)
    assert loads(b"\x82" + deep[1:] * 2, max_depth=5) == [[[[[1]]]]] * 2  # next to each other


def test_items_are_bounded():
    def array(count: int) -> bytes:
        return b"\x9a" + struct.pack(">I", count) + b"\0" * count

    assert len(loads(array(MAX_SINGLE_ITEMS - 1))) == MAX_SINGLE_ITEMS - 1
    with pytest.raises(CborError, match=r"over 15000 items; send numbers as typed arrays"):
        loads(array(MAX_SINGLE_ITEMS))


def test_small_typed_arrays_count_as_the_items_whose_time_they_take():
    most = MAX_SINGLE_ITEMS // 5
    assert loads(b"\x99" + struct.pack(">H", most - 1) + b"\xd8\x55\x40" * (most - 1))
    with pytest.raises(CborError, match="over 15000 items"):
        loads(b"\x99" + struct.pack(">H", most) + b"\xd8\x55\x40" * most)


def test_text_that_is_not_ascii_costs_three_times_as_much():
    texts = ["a" * 4_000_000, "ü" * 1_000_000, "ü" * 499_997]
    assert loads(cbor2.dumps(texts)) == texts
    with pytest.raises(CborError, match=r"takes too long to read, for its text that is not ASCII$"):
        loads(cbor2.dumps([*texts, "ü"]))


def test_numbers_in_typed_arrays_are_not_items_and_few_of_them_make_a_list():
    assert isinstance(loads(cbor2.dumps(typed(np.zeros(10_000, "<f4")))), list)
    assert isinstance(loads(cbor2.dumps(typed(np.zeros(10_001, "<f4")))), NumberArray)
    data = cbor2.dumps([typed(np.zeros(6000, "<f4"))] * 2)
    others = 11  # the array, and five for each of those within
    first, second = loads(data, max_items=others)
    assert first == [0.0] * 6000
    assert isinstance(second, NumberArray)
    assert second.values.tolist() == [0.0] * 6000
    with pytest.raises(CborError, match="over 10 items; send numbers as typed arrays"):
        loads(data, max_items=others - 1)


def test_the_operators_bound_on_items_is_kept():
    data = cbor2.dumps([0] * 9)
    assert loads(data, max_items=10) == [0] * 9
    with pytest.raises(CborError, match="over 9 items; send numbers as"):
        loads(data, max_items=9)


@pytest.mark.parametrize("name", [row.name for row in Table.load().rows])
def test_messages_that_the_gateway_sends_as_cbor_can_be_sent_back(name):
    known = TYPES.get(name)
    for seed in range(5):
        cdr = known.encode(to_json(RandomMessages(DEFINITIONS, seed).message(name)), 0)
        assert known.encode(loads(known.transcoder()(cdr)), 0) == cdr


def test_a_message_is_cbor_if_it_begins_with_a_map():
    assert is_cbor(cbor2.dumps({"op": "ping"}))
    assert is_cbor(b"\xbf")
    others = (b"", b"{}", b" {}", b"help", "\xe0".encode(), b"\x9f", b"\xc0", b"\x81\x01")
    assert not any(map(is_cbor, others))
