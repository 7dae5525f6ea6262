# SPDX-License-Identifier: Apache-2.0
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from schemas.json_forms import OctetsError, octets

OCTETS = st.integers(0, 255)
OTHERS = st.sampled_from([-1, 256, 2**64, True, False, 1.0, "1", None, [1]])


@given(st.lists(OCTETS, max_size=40), OTHERS, st.lists(OCTETS | OTHERS, max_size=40))
@example([], None, [])
@example([0] * 99_999, 256, [])
def test_the_first_item_that_is_no_octet_is_named(before, wrong, after):
    with pytest.raises(OctetsError, match=f"^item {len(before)} is no integer from 0 to 255$"):
        octets([*before, wrong, *after])


@given(st.lists(OCTETS, max_size=40))
def test_a_list_of_integers_holds_octets(items):
    assert octets(items) == bytes(items)
