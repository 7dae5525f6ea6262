# SPDX-License-Identifier: Apache-2.0
"""Long arrays of numbers are read in slices, and mean what they mean to the other reader."""

import json
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gateway.codec import json_arrays, json_bounds
from gateway.codec.error_text import JsonError
from gateway.codec.json import in_one_go, loads, loads_in_slices
from schemas.json_forms import NumberArray

INTEGERS = st.integers(-(2**63), 2**64 - 1) | st.integers(-200, 200)
NUMBERS = INTEGERS | st.floats(allow_nan=False, allow_infinity=False) | st.none()
VALUES = st.recursive(
    st.lists(INTEGERS) | st.lists(NUMBERS) | st.lists(st.booleans()) | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=2), inner),
    max_leaves=8,
)


def read(text: str | bytes) -> object:
    data = text.encode() if isinstance(text, str) else text
    return in_one_go(loads_in_slices(data))


def numbers(text: str) -> "np.ndarray[Any, Any]":
    found = read(text)
    assert isinstance(found, NumberArray)
    return found.values


def same(one: object, other: object) -> bool:
    """Compare values, of which one may have arrays of numpy for lists."""
    if isinstance(one, NumberArray):
        one = one.values
        assert isinstance(other, list)
        assert len(one) == len(other)
        if one.dtype.kind != "f":
            return bool(one.tolist() == other)
        floats = np.array(other, np.float64)
        return bool(np.array_equal(one, floats, equal_nan=True))
    match one, other:
        case dict(), dict():
            return one.keys() == other.keys() and all(same(one[key], other[key]) for key in one)
        case list(), list():
            return len(one) == len(other) and all(map(same, one, other))
    return bool(one == other)


@pytest.fixture
def short(monkeypatch):
    """Make every array a long one, and every slice short."""
    monkeypatch.setattr(json_bounds, "MIN_ARRAY_BYTES", 1)
    monkeypatch.setattr(json_bounds, "CHUNK_BYTES", 7)
    monkeypatch.setattr(json_arrays, "SLICE_BYTES", 30)


@given(VALUES, st.sampled_from([None, 1]))
def test_reading_in_slices_and_reading_at_once_give_the_same_values(value, indent):
    text = json.dumps(value, indent=indent)
    with pytest.MonkeyPatch.context() as patch:
        short.__wrapped__(patch)
        found = read(text)
    assert same(found, loads(text))


@pytest.mark.parametrize(
    "text",
    ["[1,2,]", "[1,,2]", "[,1]", "[1 2]", "[1,02]", "[1.,2]", "[+1,2]", "[1:2]", "[1,x]", "[,,]",
     "[1,\xff]", "[1,true]", "[1,2", "[1,2}", "{1,2]", '{"a":[1,2],"a":1}', "[1,[2,3]", "[1,2]]"],
)  # fmt: skip
def test_invalid_json_is_refused(short, text):
    del short
    with pytest.raises(JsonError):
        read(text.encode("latin-1"))


def test_nan_and_infinity_are_read_in_a_text_of_any_length():
    text = "[" + "0.5,NaN,null,-Infinity," * 50_000 + "Infinity]"
    found = numbers(text)
    assert len(found) == 200_001
    assert math.isnan(found[1])
    assert math.isnan(found[2])
    assert list(found[-2:]) == [-math.inf, math.inf]


def test_an_array_takes_the_least_bytes_that_hold_its_numbers():
    assert numbers("[" + "-1,0,100," * 10_000 + "127]").dtype == np.int8
    assert numbers("[" + "1,2," * 10_000 + "40000]").dtype == np.int32
    assert numbers("[" + "1," * 40_000 + f"{2**64 - 1}]").dtype == np.uint64
    assert numbers("[" + "1," * 40_000 + f"{-(2**63)}]").dtype == np.int64
    assert numbers("[" + "1," * 40_000 + f"{-(2**63) - 1}]").dtype == np.float64


def test_numbers_in_long_arrays_are_not_items_and_others_are():
    assert len(numbers("[" + "0," * 1_000_000 + "0]")) == 1_000_001
    with pytest.raises(JsonError, match="over 100000 items"):
        read("[" + '"",' + "0," * 100_000 + "0]")


def test_a_text_cannot_speak_of_arrays_itself():
    mark = json_arrays._FIRST_MARK
    long = "[" + "1," * 20_000 + "1]"
    assert read(f"[[{mark}],{'1,' * 20_000}1]")[0] == [mark]
    for text in (f"[[{mark}],{long}]", f"[{long},[{mark}]]"):
        with pytest.raises(JsonError, match="stands for an array"):
            read(text)


def test_the_elements_of_an_array_are_not_looked_for_in_a_string():
    text = json.dumps({"a": "[" + "1," * 20_000 + "1]", "b": [1, 2]})
    assert read(text) == json.loads(text)


def pauses(text: bytes) -> int:
    return sum(1 for _ in loads_in_slices(text))


def test_a_text_of_1_mib_is_looked_at_in_four_pieces():
    text = b"[" + b" " * (1024**2 - 2) + b"]"
    assert sum(1 for _ in json_bounds.outline(text, 10, takes_arrays=False)) == 4 - 1


def test_others_have_their_turn_while_a_long_text_is_looked_at_and_read():
    assert pauses(b'["' + b"a" * 1024**2 + b'"]') >= 4
    assert pauses(b"[" + b"1," * 512 * 1024 + b"1]") >= 4 + 16


@pytest.mark.parametrize("filling", [b" ", b"x", b"1"])
def test_text_behind_an_unclosed_bracket_takes_time(filling: bytes):
    with pytest.raises(JsonError, match="takes too long to read, for its numbers and white space"):
        in_one_go(loads_in_slices(b"[" + filling * 4_000_000))


def test_an_array_of_over_16_kib_is_long():
    for characters in (16 * 1024, 16 * 1024 + 1):
        text = b"[" + b"1," * 8000 + b"1" * (characters - 16_000) + b"]"
        text = text.replace(b"1" * (characters - 16_000), b"0." + b"1" * (characters - 16_002))
        slices = loads_in_slices(text, max_items=10)
        if characters > 16 * 1024:
            assert isinstance(in_one_go(slices), NumberArray)
        else:
            with pytest.raises(JsonError, match="over 10 items"):
                in_one_go(slices)
