# SPDX-License-Identifier: Apache-2.0
import cbor2
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gateway.codec import cbor

VALUES = st.recursive(
    st.booleans()
    | st.integers(-(2**63), 2**64 - 1)
    | st.floats(allow_nan=False)
    | st.text()
    | st.binary(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
)


@given(VALUES)
def test_cbor2_reads_the_written_values(value):
    assert cbor2.loads(cbor.dumps(value)) == value


@given(st.sampled_from([23, 24, 255, 256, 65535, 65536, 2**32 - 1, 2**32, 2**64 - 1]))
def test_heads_are_as_short_as_can_be(value):
    assert cbor.head(cbor.UNSIGNED, value) == cbor2.dumps(value)


def test_a_view_becomes_a_byte_string():
    assert cbor2.loads(cbor.dumps(memoryview(b"abc")[1:])) == b"bc"


def test_a_tuple_becomes_an_array():
    assert cbor2.loads(cbor.dumps((0.5, 10.0))) == [0.5, 10.0]


def test_a_value_that_frames_never_have_raises_type_error():
    with pytest.raises(TypeError, match="no CBOR for object"):
        cbor.dumps(object())
