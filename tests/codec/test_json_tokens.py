# SPDX-License-Identifier: Apache-2.0
"""NaN and infinities as Python's json writes them: taken as values, and nothing else with them."""

import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gateway.codec import json_tokens
from gateway.codec.error_text import JsonError
from gateway.codec.json import LARGE_TEXT_BYTES, MAX_TOKENS, loads
from gateway.codec.json_bounds import MAX_CONTAINERS

TOKENS = {"NaN": math.nan, "Infinity": math.inf, "-Infinity": -math.inf}
PIECES = [
    *TOKENS, *'[]{}":,- \n', "\\", '\\"', "1", "2.5", "null", "a", '"a"', '"NaN"', '"a":', ":NaN",
    "Infinit", "N", "e3", '"Infinity', "[NaN,", ",NaN]", '{"b":-Infinity}',
]  # fmt: skip
VALUES = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**63), 2**64 - 1) | st.floats() | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text() | st.sampled_from([*TOKENS]), inner),
)


def same(one, other):
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(same(one[key], other[key]) for key in one)
    if isinstance(one, list):
        return len(one) == len(other) and all(map(same, one, other))
    if isinstance(one, float) and math.isnan(one):
        return isinstance(other, float) and math.isnan(other)
    return type(one) is type(other) and one == other


def distinct(pairs):
    if len(dict(pairs)) < len(pairs):
        raise ValueError("two members of one name")
    return dict(pairs)


@pytest.mark.parametrize("token", TOKENS)
@pytest.mark.parametrize(
    "text", ["@", " @ ", "[@]", "[1,@ ,\n@]", '{"a":@}', '{"a": @ ,"b":[@,{"c":@}]}', '["\\"",@]']
)
def test_a_token_is_taken_as_a_value(token, text):
    data = text.replace("@", token)
    assert same(loads(data), json.loads(data))


@given(VALUES, st.booleans(), st.sampled_from([None, 1]))
def test_text_that_python_writes_is_read_as_python_reads_it(value, ensure_ascii, indent):
    try:
        text = json.dumps(value, ensure_ascii=ensure_ascii, indent=indent).encode()
        text.decode().encode()
        json.loads(text)
    except UnicodeError:
        return
    # a lone surrogate, perhaps. Hypothesis knows the integers in the source
    if b"\\ud" in text or json_tokens._MARK in text:
        return
    assert same(loads(text), json.loads(text))


@given(st.lists(st.sampled_from(PIECES), max_size=14).map("".join))
def test_only_text_that_python_refuses_is_refused(text):
    try:
        expected = json.loads(text, object_pairs_hook=distinct)
    except ValueError:
        with pytest.raises(JsonError):
            loads(text)
    else:
        assert same(loads(text), expected)


@pytest.mark.parametrize(
    "text",
    [
        "{NaN:1}", "{NaN :1}", '{"a":1,NaN}', "[-NaN]", "[+Infinity]", "[--Infinity]",
        "[- Infinity]",
        "[Infinity1]", "[1NaN]", "[1 NaN]", "[NaN NaN]", "[NaNNaN]", "[nan]", "[inf]", "[NaN]]",
        '["a"NaN]', '[NaN"a"]', "[Infinity.5]", "[NaN", "NaN,1", "[NaN,]", "[\x0bNaN]", "[NaN\x0b]",
    ],
)  # fmt: skip
def test_a_token_in_any_other_place_is_refused(text):
    with pytest.raises(JsonError, match=r"^frame is not JSON: "):
        loads(text)


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ('{"a":\n  NaN x}', "line 2, column 3$"),
        ("[-Infinity,tru]", "line 1, column 12$"),
        ('["ü",NaN,1e999]', "line 1, column 10$"),
        ("[nope,NaN]", "line 1, column 2$"),
    ],
)
def test_an_error_next_to_a_token_has_its_place_in_the_client_s_text(text, place):
    with pytest.raises(JsonError, match=place) as caught:
        loads(text)
    assert caught.value.offset is not None


@pytest.mark.parametrize("token", TOKENS)
def test_tokens_can_be_refused(token):
    with pytest.raises(JsonError, match=r"at line 1, column 2|at line 1, column 3"):
        loads(f"[{token}]", takes_tokens=False)


def test_the_bounds_hold_for_text_with_tokens():
    with pytest.raises(JsonError, match="deeper than 3 levels"):
        loads("[[[[NaN]]]]", max_depth=3)
    with pytest.raises(JsonError, match="over 3 items"):
        loads("[NaN,1,2,3]" + " " * 8, max_items=3)
    with pytest.raises(JsonError, match="objects and arrays"):
        loads("[NaN" + ",[]" * MAX_CONTAINERS + "]")
    with pytest.raises(JsonError, match='duplicate key "a"'):
        loads('{"a":NaN,"a":1}')
    with pytest.raises(JsonError, match="not UTF-8 at offset 6"):
        loads(b'[NaN,"\xff"]')


def test_a_long_text_with_tokens_is_refused_with_what_to_write_instead():
    text = "[NaN," + " " * (LARGE_TEXT_BYTES - 7) + "1]"
    assert loads(text)
    with pytest.raises(JsonError, match=r"at most 256 KiB with NaN or Infinity; write them as str"):
        loads(" " + text)


def test_too_many_tokens_are_refused_and_strings_count():
    for text in ('"a",', "NaN,"):
        loads(f"[{text * (MAX_TOKENS - 1)}NaN]")
        with pytest.raises(JsonError, match="at most 20000 strings and NaN or Infinity"):
            loads(f"[{text * MAX_TOKENS}NaN]")
        loads("[" + '"a",' * MAX_TOKENS + "1]")


def test_the_integers_that_stand_for_tokens_are_refused_only_with_tokens():
    for number, value in json_tokens._NUMBERS.items():
        assert loads(f"[{number}]") == [number]
        assert same(loads(json.dumps([value])), [value])
        for text in (f"[NaN,{number}]", f'["{number}",NaN]', f'{{"{number}":NaN}}'):
            with pytest.raises(JsonError):
                loads(text)
