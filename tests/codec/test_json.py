# SPDX-License-Identifier: Apache-2.0

import json
import math
import re
import tracemalloc

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from gateway.codec import json_bounds
from gateway.codec.error_text import JsonError
from gateway.codec.json import ascii_only, dumps, in_one_go, invalid_at, loads
from gateway.codec.json_bounds import MAX_STRINGS, outline

KIB_256 = 256 * 1024


def test_arrays_are_written_as_arrays_and_non_finite_numbers_as_null():
    values = {
        "floats": np.array([0.1, math.nan, math.inf], "f4"),
        "ints": np.array([2**64 - 1], "u8"),
        "bools": np.array([True, False]),
        "tuple": (1.5, math.nan, -math.inf),
        "text": "grüße",
    }
    assert dumps(values).decode() == (
        '{"floats":[0.1,null,null],"ints":[18446744073709551615],"bools":[true,false],'
        '"tuple":[1.5,null,null],"text":"grüße"}'
    )


@pytest.mark.parametrize(
    "text",
    [
        '{"op":"publish","msg":{"data":[1,2.5,true,null,"x"]}}',
        '{"op":"subscribe","id":"subscribe:/odom:1","topic":"/odom"}',
        '{ "a" : 1 , "b" : ":" }',
        '{"a\\u003a":1,"b":"\\":"}',
        '[{"a":1},{"a":1}]',
        '{"a":{"a":{"a":1}}}',
        '":" ',
        "3",
        '{"":0}',
    ],
)
def test_json_is_read(text):
    assert loads(text) == loads(text.encode()) == json.loads(text)


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (b"", r"frame is not JSON: .* at line 1, column 1$"),
        (b"hello", r"frame is not JSON: unexpected .* at line 1, column 1$"),
        (
            b"\xef\xbb\xbf{}",
            r"frame is not JSON: UTF-8 byte order mark \(BOM\) is not supported at ",
        ),
        (b"[1e999]", r"frame is not JSON: .* at line 1, column 2$"),
        (b"[1,]", r"frame is not JSON: "),
        (b"{'a':1}", r"frame is not JSON: "),
        (b'{"a":1} {"b":2}', r"frame is not JSON: .* at line 1, column"),
        (b'["\\ud800"]', r"frame is not JSON: "),
        (b'["\xff"]', r"frame is not UTF-8 at offset 2$"),
        (b'["\xed\xa0\x80"]', r"frame is not UTF-8 at offset 2$"),
    ],
)
def test_invalid_json_raises_json_error_with_the_place(data, reason):
    with pytest.raises(JsonError, match=f"^{reason}") as caught:
        loads(data)
    assert caught.value.offset is not None


def test_the_offset_counts_octets():
    with pytest.raises(JsonError) as caught:
        loads('["grüße",\n x]')
    assert caught.value.offset == len('["grüße",\n '.encode())


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ('{"a":1,"a":1}', "a"),
        ('{"a" :1,"a":1}', "a"),
        ('{"a"\n:1,"a":":"}', "a"),
        ('{"a" :1,"a":2}', "a"),
        ('{"a"\n:1,"a":2}', "a"),
        ('{"a"\r:1,"a":2}', "a"),
        ('{"a"\t:1,"a":2}', "a"),
        ('{"msg":[{"x":1,"y":2,"x":3}]}', "x"),
        ('{"a":":","a":1}', "a"),
        ('{"a":1,"a":"\\u003a"}', "a"),
        ('{"a":1,"\\u0061":2}', "a"),
        ('{"a":{"b":1,"c":2},"a":{":":":"}}', "a"),
        ('{"a":"\\":","a":1}', "a"),
        ('{"a":1,"b":"\\":","a" :2}', "a"),
        ('{"":1,"":2}', ""),
    ],
)
def test_a_duplicate_key_raises_json_error_naming_it(text, key):
    with pytest.raises(JsonError) as caught:
        loads(text)
    assert str(caught.value) == f'duplicate key "{key}"'


def test_the_name_of_a_duplicate_key_comes_back_truncated():
    name = "k" * 200
    with pytest.raises(JsonError) as caught:
        loads(f'{{"{name}":1,"{name}":2}}')
    assert str(caught.value) == f'duplicate key "{name[:128]}"'


SCALARS = st.one_of(
    st.sampled_from(
        [
            *("1", "null", "[]", "{}"),
            *('":"', '"\\":"', '"\\u003a"', '"a"', '" :"', '"\\\\"', '"\\\\\\":"', '":\\\\"'),
        ]
    )
)
NAMES = st.sampled_from(['"a"', '"b"', '":"', '"\\":"', '"\\u0061"', '" :"'])
COLONS = st.sampled_from([":", " :", ": ", "\n:\t", "\r:", "\t:"])


def objects(texts):
    members = st.tuples(NAMES, COLONS, texts).map("".join)
    return st.lists(members, max_size=4).map(lambda members: f"{{{','.join(members)}}}")


def arrays(texts):
    return st.lists(texts, max_size=3).map(lambda items: f"[{','.join(items)}]")


TEXTS = st.recursive(SCALARS, lambda texts: objects(texts) | arrays(texts), max_leaves=10)


@given(TEXTS)
def test_duplicates_are_found_wherever_they_are_and_only_there(text):
    def refuse(pairs):
        if len(dict(pairs)) < len(pairs):
            raise KeyError
        return dict(pairs)

    try:
        expected = json.loads(text, object_pairs_hook=refuse)
    except KeyError:
        with pytest.raises(JsonError, match=r"^duplicate key "):
            loads(text)
    else:
        assert loads(text) == expected


@given(TEXTS, st.integers(0, 70), st.sampled_from([1, 7, 64, 65, 4096]))
def test_contents_of_strings_are_not_counted_wherever_a_text_is_cut(text, before, piece):
    text = " " * before + text
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(json_bounds, "CHUNK_BYTES", piece)
        found = in_one_go(outline(text.encode(), 10_000, takes_arrays=False))
    rest = re.sub(r'"(?:[^"\\]|\\.)*"', '"', text)
    assert (found.strings, found.colons, found.commas) == tuple(map(rest.count, '":,'))
    assert found.containers == rest.count("[") + rest.count("{")
    assert found.empty == rest.count("[]") + rest.count("{}")


@given(st.binary(max_size=60) | st.text(max_size=60))
@example(b"[" * 600)
@example(b'{"a":' * 600)
def test_anything_is_read_or_raises_json_error(data):
    try:
        loads(data)
    except JsonError:
        return


@pytest.mark.parametrize("brackets", ["[]", ("[1,", "]"), ('{"a":', "}")])
def test_depth_is_bounded(brackets):
    opening, closing = brackets
    inner = "1" if opening != "[" else ""
    loads(opening * 32 + inner + closing * 32)
    with pytest.raises(
        JsonError, match=r"^JSON nests deeper than 32 levels; raise limits.max_json_depth$"
    ):
        loads(opening * 33 + inner + closing * 33)
    with pytest.raises(JsonError, match=r"^JSON nests deeper than 2 levels; raise"):
        loads(opening * 3 + inner + closing * 3, max_depth=2)


@pytest.mark.parametrize("levels", [600, 2000])  # orjson has two words for it
def test_a_text_that_only_opens_nests_too_deep(levels):
    with pytest.raises(
        JsonError, match=r"^JSON nests deeper than 32 levels; raise limits.max_json_depth$"
    ):
        loads("[" * levels)


def test_items_are_bounded():
    text = "[" + "0," * 100_000 + "0]"
    with pytest.raises(
        JsonError, match=r"^JSON has over 100000 items; send fewer, or raise limits.max_json_items$"
    ):
        loads(text)
    assert len(loads(text, max_items=100_001)) == 100_001


def test_an_empty_array_is_one_item():
    assert loads("[" + "[]," * 15_000 + "0," * 80_000 + "0]")
    with pytest.raises(
        JsonError, match=r"^JSON has over 100000 items; send fewer, or raise limits.max_json_items$"
    ):
        loads("[" + "[]," * 15_000 + "0," * 85_000 + "0]")


@pytest.mark.parametrize("inner", ["[]", "{}", "[{},[]]", '{"a":{}}', "[0,0]"])
def test_objects_and_arrays_are_bounded(inner):
    each = inner.count("{") + inner.count("[")
    most = (20_000 - 1) // each
    assert len(loads(f"[{','.join([inner] * most)}]")) == most
    with pytest.raises(
        JsonError, match=r"^JSON has over 20000 objects and arrays; send fewer at once$"
    ):
        loads(f"[{','.join([inner] * (most + 1))}]")


def test_strings_are_bounded_and_names_count():
    for text in ('["",{"a":"b"}%s]', '["\\"",{"a":"b"}%s]'):
        assert len(loads(text % (',""' * (MAX_STRINGS - 3)))) == MAX_STRINGS - 1
        with pytest.raises(
            JsonError, match=r"^JSON has over 60000 strings, names included; send fewer at once$"
        ):
            loads(text % (',""' * (MAX_STRINGS - 2)))
    assert loads(json.dumps(['"' * 125_000]))  # quotes in a string, in a text that is not large


def test_commas_and_brackets_in_strings_are_not_items():
    text = json.dumps(["[,{" * 30_000, '\\",' * 20_000])
    assert loads(text) == json.loads(text)


def test_contents_of_strings_in_a_large_text_are_not_items():
    for text in (["a" * 250, ",[{:" * 60] * 1100, [",[{:" * 200_000, "\\" * 60_000, '"' * 10_000]):
        assert loads(json.dumps(text)) == text
    many = ["a" * 250] * 1100
    assert loads(json.dumps([*many, *[0] * 98_900]))
    with pytest.raises(
        JsonError, match=r"^JSON has over 100000 items; send fewer, or raise limits.max_json_items$"
    ):
        loads(json.dumps([*many, *[0] * 98_901]))


def cost_of(text: str) -> int:
    """Return what a text costs, by its parts, as the limits in the documentation say."""
    size = len(text.encode())
    outside = re.sub(r'"(?:[^"\\]|\\.)*"', '"', text)
    is_wide = not text.isascii() or re.search(r"\\u(?!00)", text) is not None
    parts = (4 * len(outside), 80 * outside.count('"'), 28 * text.count(chr(92)))
    return size * (3 if is_wide else 1) + sum(parts)


@pytest.mark.parametrize(
    ("reason", "start", "filling"),
    [
        ("numbers and white space", "[0,", " "),
        ("strings", '["' + 'a","' * 55_000, "a"),
        ("backslashes", '["', "\\n"),
        ("backslashes", '["', "\\" * 64),
        ("backslashes", '["', "\\u003d"),
        ("characters that are not ASCII", '["\u00e4', "a"),
        ("characters that are not ASCII", '["\U0001f600', "a"),
        ("characters that are not ASCII", '["\\u0100', "a"),
        ("characters that are not ASCII", '["\\ud83d\\ude00', "a"),
    ],
)
def test_text_that_takes_too_long_to_read_is_refused(reason, start, filling):
    end = '"]' if start.count('"') % 2 else "1]"
    each = cost_of(start + filling * 2 + end) - cost_of(start + filling + end)
    count = (13_000_000 - cost_of(start + end)) // each
    assert loads(start + filling * count + end)
    with pytest.raises(
        JsonError, match=rf"^JSON of \d+ bytes takes too long to read, for its {reason};"
    ):
        loads(start + filling * (count + 1) + end)


def test_a_text_that_is_too_long_is_refused_for_its_length():
    assert loads('["' + "a" * 12_999_000 + '"]')
    with pytest.raises(JsonError, match="too long to read, for its length"):
        loads('["' + "a" * 13_000_000 + '"]')


def test_text_of_other_writers_does_not_take_too_long():
    numbers = [0.1234567890123456 + index * 1e-16 for index in range(99_900)]
    for text in (
        json.dumps({"ranges": numbers}, indent=2),
        json.dumps([{"x": 0.12345678901234567, "y": 0, "z": 0.5}] * 19_900, indent=2),
        json.dumps({"data": "/" * 400_000}).replace("/", r"\/"),  # org.json, of a white picture
        json.dumps({"data": "A" * 8_000_000 + "=="}).replace("=", r"\u003d"),  # Gson
    ):
        assert loads(text) == json.loads(text)


def test_in_a_large_text_with_few_strings_they_do_not_count():
    text = json.dumps({"a": ",[{:" * 200_000, "b": "x::", "c d": ["a:", {"e": 1}]})
    assert loads(text) == json.loads(text)
    spaced = text.replace('":', '" \n:')
    assert loads(spaced) == json.loads(text)


def test_a_duplicate_in_a_large_text_is_found_though_not_named():
    filling = '"' + "a" * 300_000 + '"'
    assert loads(f'{{"a": ":", "b" : {filling}}}')
    assert loads(f'{{"a": "\\":", "b" : {filling}}}')
    with pytest.raises(JsonError, match=r"^an object has two members of one name$"):
        loads(f'{{"a":{filling}, "b": "\\":", "a" : 1}}')
    with pytest.raises(JsonError, match=r"^an object has two members of one name$"):
        loads(f'{{"a":{filling}, "b": ":", "a" : 1}}')


@pytest.mark.parametrize(
    "bomb",
    [
        b"[" * KIB_256,
        b"[" * (KIB_256 // 2) + b"]" * (KIB_256 // 2),
        b'{"a":' * (KIB_256 // 5),
        b"[" + b"0," * (KIB_256 // 2),
        b"[" + b"[0]," * (KIB_256 // 4) + b"0]",
        b'["' + b'\\"' * (KIB_256 // 4) + b"," * (KIB_256 // 2),
        b'["' + b"\\" * (KIB_256 // 2) + b"," * (KIB_256 // 2),
    ],
    ids=["open", "nested", "objects", "tiny", "arrays", "quotes", "backslashes"],
)
def test_a_bomb_is_refused_before_it_is_built(bomb):
    tracemalloc.start()
    try:
        with pytest.raises(JsonError):
            loads(bomb)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < 48 * len(bomb)


def test_no_memory_is_taken_for_each_of_too_many_backslashes():
    bomb = b'"' + b"\\" * 4_000_000
    tracemalloc.start()
    try:
        with pytest.raises(JsonError, match="for its backslashes"):
            loads(bomb)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < 4 * len(bomb)


def test_many_escaped_quotes_do_not_take_quadratic_time():
    # A minute's work if each of them began a search to the end.
    bomb = b'["' + b'\\"' * 1_000_000 + b"," * 200_000
    with pytest.raises(JsonError):
        loads(bomb)


@given(st.recursive(st.text(), lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner)))
def test_escaped_json_is_ascii_and_the_same(value):
    escaped = ascii_only(dumps(value))
    assert escaped.isascii()
    assert json.loads(escaped) == value


def test_characters_beyond_16_bits_are_escaped_as_surrogate_pairs():
    assert ascii_only('{"ä":"a\\"🤖"}'.encode()) == rb'{"\u00e4":"a\"\ud83e\udd16"}'


def test_ascii_text_is_not_copied():
    text = b'{"a":1}'
    assert ascii_only(text) is text


PIECE = 64 * 1024


def place(data: bytes) -> int | None:
    try:
        data.decode()
    except UnicodeDecodeError as error:
        return error.start
    return None


TEXTS = st.lists(st.binary(max_size=3) | st.text(max_size=3).map(str.encode)).map(b"".join)


@given(st.integers(0, 8), TEXTS)
@example(2, "😀".encode())
@example(2, "😀".encode()[:3])
@example(0, b"\xf0\x9f\x98\x80\x80")
def test_invalid_utf8_is_found_where_python_finds_it(before_the_cut, text):
    for data in (text, b"a" * (PIECE - before_the_cut) + text + b"a" * PIECE):
        assert invalid_at(data) == place(data)


def test_a_long_text_is_looked_at_without_a_copy_of_it():
    data = "\u20ac".encode() * 1_000_000
    tracemalloc.start()
    assert invalid_at(data) is None
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 8 * PIECE
