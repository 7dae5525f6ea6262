# SPDX-License-Identifier: Apache-2.0
import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gateway.codec.json import dumps, loads
from gateway.codec.types import Types
from gateway.core.rosapi.parameter_values import (
    ParameterType,
    ParameterValueError,
    message_of,
    type_word,
    value_of,
)
from schemas.installed import InstalledDefinitions

PARAMETER_VALUE = Types(InstalledDefinitions()).get("rcl_interfaces/msg/ParameterValue")
INTEGERS = st.integers(-(2**63), 2**63 - 1)
DOUBLES = st.floats(allow_nan=False, allow_infinity=False)
TEXTS = st.text(st.characters(exclude_characters="\0", exclude_categories=["Cs"]))
SCALARS = st.booleans() | INTEGERS | DOUBLES | TEXTS


def list_of(values: Any) -> Any:
    return st.lists(values, min_size=1, max_size=5)


def travelled(message: dict[str, object]) -> Any:
    """Return the value after its way through CDR."""
    cdr = PARAMETER_VALUE.encode(message, 0)
    return value_of(PARAMETER_VALUE.decode(cdr))


@given(SCALARS | list_of(st.booleans()) | list_of(INTEGERS) | list_of(DOUBLES) | list_of(TEXTS))
def test_a_value_comes_back_as_it_went(value: Any) -> None:
    got = travelled(message_of(value, ParameterType.NOT_SET))
    assert (list(got) if isinstance(value, list) else got) == value


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_numbers_that_json_does_not_have_come_back_by_their_names(value: float) -> None:
    for sent in (value, [value, 1.5]):
        got = loads(dumps(travelled(message_of(sent, ParameterType.NOT_SET))))
        name = got[0] if isinstance(sent, list) else got
        assert isinstance(name, str)
        assert str(float(name)) == str(value)
        own_type = ParameterType.DOUBLE_ARRAY if isinstance(sent, list) else ParameterType.DOUBLE
        assert loads(dumps(travelled(message_of(got, own_type)))) == got


@pytest.mark.parametrize("wanted", [ParameterType.NOT_SET, ParameterType.BYTE_ARRAY])
def test_octets_are_a_value_too(wanted: ParameterType) -> None:
    assert travelled(message_of(b"\1\2", wanted)) == "AQI="


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text() | st.binary(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=5,
)


@given(JSON, st.sampled_from(ParameterType))
def test_any_value_of_a_client_is_a_valid_message_or_refused(
    value: Any, wanted: ParameterType
) -> None:
    try:
        message = message_of(value, wanted)
    except ParameterValueError:
        return
    PARAMETER_VALUE.encode(message, 0)


@pytest.mark.parametrize(
    ("value", "wanted", "reason"),
    [
        (True, ParameterType.INTEGER, "expected an integer of 64 bits, got true"),
        (2**63, ParameterType.INTEGER, "expected an integer of 64 bits, got 9223372036854775808"),
        ("inf", ParameterType.DOUBLE, 'expected a number, "NaN", "Infinity" or "-Infinity", got'),
        (10**400, ParameterType.DOUBLE, "expected a number"),
        ("a\0b", ParameterType.STRING, "expected a string without U+0000, got a string"),
        ("!", ParameterType.BYTE_ARRAY, "expected bytes: base64"),
        ([256], ParameterType.BYTE_ARRAY, "expected bytes: base64"),
        ([True], ParameterType.BYTE_ARRAY, "expected bytes: base64"),
        (
            [1, None],
            ParameterType.INTEGER_ARRAY,
            r"\[1\]: expected an integer of 64 bits",
        ),
        ([1, "a"], ParameterType.NOT_SET, "expected an array of values of one kind"),
        ([[1]], ParameterType.NOT_SET, "expected an array of values of one kind"),
        ([None], ParameterType.NOT_SET, "expected a boolean, a number, a string or an array"),
    ],
)
def test_the_error_says_the_reason(value: Any, wanted: ParameterType, reason: str) -> None:
    with pytest.raises(ParameterValueError, match=f"^{reason.replace('+', '[+]')}"):
        message_of(value, wanted)


def test_a_type_of_a_later_ros_is_as_none() -> None:
    assert type_word(99) == "not_set"
    assert value_of({"type": 99, "bool_value": False}) is None
    assert message_of(True, ParameterType(99))["type"] == ParameterType.BOOL
