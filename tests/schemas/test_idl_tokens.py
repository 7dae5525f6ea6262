# SPDX-License-Identifier: Apache-2.0
"""The words of IDL, and the values that they stand for."""

import math
from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from schemas.idl_tokens import IdlToken, PlaceError, items, number, string, tokens


def words(text):
    return [(token.kind, token.text) for token in tokens(text)][:-1]


def test_words_are_told_apart_with_and_without_blanks():
    assert words('@key long a__9[9];//x\n"a//b"L"c" 1.5e-3-2') == [
        ("symbol", "@"), ("name", "key"), ("name", "long"), ("name", "a__9"), ("symbol", "["),
        ("number", "9"), ("symbol", "]"), ("symbol", ";"), ("string", '"a//b"'),
        ("string", 'L"c"'), ("number", "1.5e-3"), ("symbol", "-"), ("number", "2"),
    ]  # fmt: skip
    assert words("a::b:c>>d") == [
        ("name", "a"), ("symbol", "::"), ("name", "b"), ("symbol", ":"), ("name", "c"),
        ("symbol", ">"), ("symbol", ">"), ("name", "d"),
    ]  # fmt: skip
    assert words('#include "a.idl" # include <b.idl>') == [
        ("include", '#include "a.idl"'), ("include", "# include <b.idl>")
    ]  # fmt: skip
    assert words("/**/ a /* * / \n */ b") == [("name", "a"), ("name", "b")]


def test_each_word_knows_where_it_begins():
    text = "  a /* b */ c"
    assert [text[token.offset :][:1] for token in tokens(text)] == ["a", "c", ""]


@pytest.mark.parametrize(
    ("text", "value"),
    [("0", 0), ("12", 12), ("017", 15), ("0x1F", 31), ("0Xff", 255), ("1.5", 1.5), ("1.", 1.0),
     (".5", 0.5), ("1e3", 1000.0), ("1.5E+3", 1500.0), ("2d", 2.0), ("2.5D", 2.5),
     ("1e999", math.inf)],
)  # fmt: skip
def test_numbers_are_read_as_the_standard_says(text, value):
    ((_, word),) = words(text)
    found = number(IdlToken("number", word, 0))
    assert (found, type(found)) == (value, type(value))


@pytest.mark.parametrize("text", ["10UL", "0x", "08", "1e", "1.5f", "1.2.3", "1_0", "9" * 5000])
def test_other_numbers_are_refused(text):
    ((_, word),) = words(text)
    with pytest.raises(PlaceError, match="expected a number such as 12"):
        number(IdlToken("number", word, 0))


@pytest.mark.filterwarnings("ignore:.*invalid escape sequence:DeprecationWarning")  # \\?
@given(
    st.text(st.sampled_from("\\\\\\\"n0x4u1?'a ü"), max_size=12),
    st.booleans(),
)
def test_a_string_is_read_as_rosidl_reads_it(inner, is_wide):
    parser = pytest.importorskip("rosidl_parser.parser")
    word = f'{"L" if is_wide else ""}"{inner}"'
    with suppress(PlaceError):
        found = [token for token in tokens(word) if token.kind != "end"]
        if [token.text for token in found] != [word]:
            return  # it ends before, or does not
        ours = string(found[0])
        kind = "ESCAPED_WIDE_STRING" if is_wide else "ESCAPED_STRING"
        tree = parser.Tree("string_literal", [parser.Token(kind, word)])
        assert ours == parser.get_string_literal_value(tree, allow_unicode=is_wide)


def test_surrogates_in_a_wide_string_are_joined():
    assert string(IdlToken("string", r'L"\ud83e\udd16"', 0)) == "\U0001f916"


@given(st.lists(st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text()))
def test_a_default_of_an_array_is_read_as_python_wrote_it(values):
    text = repr(tuple(values))
    try:
        found = items(IdlToken("string", "", 0), text)
    except PlaceError:
        texts = [value for value in values if isinstance(value, str)]
        assert any("\ud800" <= c <= "\udfff" for each in texts for c in each)
        return
    assert found == tuple(values)
    assert list(map(type, found)) == list(map(type, values))
