# SPDX-License-Identifier: Apache-2.0
import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from gateway.codec.json import dumps
from gateway.codec.nonfinite import named, writer

NAMES = {"string": str, "token": float}
SINGLES = st.floats(width=32).map(np.float32)
ARRAYS = st.sampled_from([np.float32, np.float64, np.int16]).flatmap(
    lambda dtype: arrays.arrays(dtype, st.integers(0, 40))
)
VALUES = st.recursive(
    st.floats() | SINGLES | st.integers(-5, 5) | st.booleans() | st.sampled_from(["null", "NaN,"]),
    lambda inner: (
        st.lists(inner) | ARRAYS | st.dictionaries(st.sampled_from(["null", "a", "b"]), inner)
    ),
)


def plain(value):
    if isinstance(value, dict):
        return {name: plain(item) for name, item in value.items()}
    if isinstance(value, list):
        return list(map(plain, value))
    return value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value


def as_asked(value, form):
    """Return what Python reads of the JSON that a client asks for."""
    if isinstance(value, dict):
        return {name: as_asked(item, form) for name, item in value.items()}
    if isinstance(value, list):
        return [as_asked(item, form) for item in value]
    if not isinstance(value, float) or math.isfinite(value):
        return json.loads(dumps(value))
    return {"null": None, "string": json.dumps(value), "token": f"token {value}"}[form]


def read(text):
    return json.loads(text, parse_constant=lambda name: f"token {float(name)}")


@pytest.mark.parametrize("form", ["null", "string", "token"])
@given(value=VALUES)
def test_non_finite_numbers_have_the_form_that_was_asked_for(form, value):
    single = json.loads(dumps(value))  # float32 with as many digits as they need
    expected = as_asked(plain(value), form)
    found = read(writer(form)(value))
    assert same(found, expected, single)


def same(found, expected, digits):
    if isinstance(expected, dict):
        return found.keys() == expected.keys() and all(
            same(found[key], expected[key], digits[key]) for key in expected
        )
    if isinstance(expected, list):
        return len(found) == len(expected) == len(digits) and all(
            map(same, found, expected, digits)
        )
    return found == (expected if isinstance(expected, str) or expected is None else digits)


def test_finite_values_are_written_as_ever():
    value = {"text": "null", "ranges": np.arange(30, dtype=np.float32), "few": (1.5, 2)}
    for form in ("null", "string", "token"):
        assert writer(form)(value) == dumps(value)


def test_an_array_with_infinities_keeps_the_digits_of_its_type():
    ranges = np.array([0.1, np.inf, -np.inf, np.nan, 1e13], np.float32)
    assert writer("string")({"ranges": ranges}) == (
        b'{"ranges":[0.1,"Infinity","-Infinity","NaN",1e+13]}'
    )
    assert writer("token")([ranges]) == b"[[0.1,Infinity,-Infinity,NaN,1e+13]]"
    assert writer("null") is dumps


def test_values_without_a_form_are_left_alone():
    value = {"x": math.inf}
    assert named(value, "null") is value
