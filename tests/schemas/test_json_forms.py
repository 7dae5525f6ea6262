# SPDX-License-Identifier: Apache-2.0
import json
import math

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from schemas.json_forms import NON_FINITE, OctetsError, octets, whole, wholes

OCTETS = st.integers(0, 255)
OTHERS = st.sampled_from([-1, 256, 256.0, 2**64, True, False, 1.5, "1", None, [1]])


@given(st.lists(OCTETS, max_size=40), OTHERS, st.lists(OCTETS | OTHERS, max_size=40))
@example([], None, [])
@example([0] * 99_999, 256, [])
def test_the_first_item_that_is_not_an_octet_is_named(before, wrong, after):
    with pytest.raises(OctetsError, match=f"^item {len(before)} is not an integer from 0 to 255$"):
        octets([*before, wrong, *after])


@given(st.lists(OCTETS | OCTETS.map(float), max_size=40))
def test_a_list_of_integers_holds_octets(items):
    assert octets(items) == bytes(map(int, items))


@given(st.floats())
def test_a_float_is_an_integer_if_it_is_one_of_those_that_floats_tell_apart(value):
    is_integer = value % 1 == 0 and abs(value) <= 2**53
    assert type(whole(value)) is (int if is_integer else float)
    assert whole(value) == value or math.isnan(value)


@given(st.lists(st.integers(-(2**63), 2**64) | st.integers(-(2**53), 2**53).map(float)))
@example([2**53 + 1, 1.0])
@example([-(2**53) - 1, 1.0])
def test_integers_and_floats_without_a_fraction_are_exact_integers(values):
    found = wholes(values)
    assert found == list(map(int, values))
    assert set(map(type, found)) <= {int}


def test_names_of_non_finite_numbers_are_those_of_javascript_and_of_python():
    for name in ("Infinity", "-Infinity", "NaN"):
        assert json.dumps(NON_FINITE[name]) == name
