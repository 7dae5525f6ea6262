# SPDX-License-Identifier: Apache-2.0
import json
import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gateway.core.errors import ProtocolError
from gateway.fronts.rosbridge.fragments import (
    MAX_AGE_NS,
    MAX_INCOMPLETE,
    MAX_PIECES,
    Assembly,
)
from gateway.fronts.rosbridge.operations.fragment import Fragment
from gateway.fronts.rosbridge.publish_frames import text_frames
from tests.wire import unpacked, websocket_frames

TOO_LARGE = "at most 1000 allowed in all (limits.max_message_bytes): send less at once"
LIMIT = 1000


def fragment(num, total, data="x", fragment_id="f"):
    return Fragment(id=fragment_id, num=num, total=total, data=data)


def pieces_of(text, size, fragment_id="f"):
    pieces = [text[start : start + size] for start in range(0, len(text), size)] or [""]
    return [fragment(num, len(pieces), piece, fragment_id) for num, piece in enumerate(pieces)]


@given(st.text(min_size=1, max_size=300), st.integers(1, 80))
def test_a_text_that_is_split_is_the_same_when_joined(value, size):
    text = json.dumps(value, ensure_ascii=False)
    frames = websocket_frames(text_frames(text.encode(), size, "some id"))
    if len(text) <= size:
        assert [frame.data for frame in frames] == [text.encode()]
        return
    pieces = [json.loads(bytes(frame.data)) for frame in frames]
    assert [piece["num"] for piece in pieces] == list(range(len(pieces)))
    assert {piece["total"] for piece in pieces} == {len(pieces)}
    assert all(type(piece["total"]) is int for piece in pieces)
    assert {(piece["op"], piece["id"]) for piece in pieces} == {("fragment", "some id")}
    assert {len(piece["data"]) for piece in pieces[:-1]} <= {size}
    assert 0 < len(pieces[-1]["data"]) <= size
    assert "".join(piece["data"] for piece in pieces) == text


def test_a_limit_counts_characters_not_bytes():
    text = '"ハロー"'
    assert len(websocket_frames(text_frames(text.encode(), 5, "f"))) == 1
    assert [piece["data"] for piece in unpacked(text_frames(text.encode(), 4, "f"))] == [
        '"ハロー',
        '"',
    ]


@pytest.mark.parametrize("size", [None, 2**31 - 1])
def test_a_client_that_wants_no_fragments_gets_none(size):
    text = b'"' + b"x" * 100_000 + b'"'
    assert [frame.data for frame in websocket_frames(text_frames(text, size, "f"))] == [text]


@given(
    st.lists(st.text(max_size=60), min_size=1, max_size=MAX_INCOMPLETE),
    st.integers(1, 20),
    st.randoms(use_true_random=False),
)
def test_pieces_of_several_messages_come_in_any_order_and_twice(texts, size, chance):
    assembly = Assembly(LIMIT)
    last = {}
    messages = []
    for number, text in enumerate(texts):
        pieces = pieces_of(text, size, number)
        chance.shuffle(pieces)
        last[number] = pieces.pop()
        messages += pieces * 2
    chance.shuffle(messages)
    assert all(assembly.add(piece, 0) is None for piece in messages)
    for number, text in enumerate(texts):
        assert assembly.add(last[number], 0) == text.encode()


def refused(assembly, piece, now_ns=0):
    with pytest.raises(ProtocolError) as caught:
        assembly.add(piece, now_ns)
    return caught.value.code, str(caught.value)


def test_a_total_that_contradicts_is_refused_and_the_message_goes_on():
    assembly = Assembly(LIMIT)
    assembly.add(fragment(0, 2, "a"), 0)
    assert refused(assembly, fragment(1, 3, "b")) == ("bad_request", "total: 3, but 2 before")
    assert assembly.add(fragment(1, 2, "b"), 0) == b"ab"


def test_a_number_beyond_the_total_is_refused():
    expected = ("bad_request", "num: 2, expected less than 2")
    assert refused(Assembly(LIMIT), fragment(2, 2)) == expected


def test_a_piece_that_comes_again_with_other_data_is_refused():
    assembly = Assembly(LIMIT)
    assembly.add(fragment(0, 2, "a"), 0)
    assert assembly.add(fragment(0, 2, "a"), 0) is None
    expected = ("bad_request", "num: piece 0 has come before with other data")
    assert refused(assembly, fragment(0, 2, "b")) == expected


def test_a_message_that_grows_too_large_is_refused_and_forgotten():
    assembly = Assembly(LIMIT)
    for fragment_id in range(2 * MAX_INCOMPLETE):
        assembly.add(fragment(0, 2, "ä" * 400, fragment_id), 0)
        code, text = refused(assembly, fragment(1, 2, "x" * 201, fragment_id))
        assert (code, text) == (
            "limit_exceeded",
            f"data: 1001 bytes so far, {TOO_LARGE}",
        )


def test_the_rest_of_a_refused_message_is_ignored():
    assembly = Assembly(LIMIT)
    for fragment_id in range(MAX_INCOMPLETE):
        assembly.add(fragment(0, 4, "x" * 900, fragment_id), 0)
        refused(assembly, fragment(1, 4, "x" * 900, fragment_id))
    for num in (2, 3):
        for fragment_id in range(MAX_INCOMPLETE):
            assert assembly.add(fragment(num, 4, "x" * 900, fragment_id), 0) is None
            assert len(assembly) == 0
    # all of it has passed, so this is another one
    assembly.add(fragment(2, 4, "x", 0), 0)
    assert len(assembly) == 1


def test_the_rest_of_a_message_that_was_one_too_many_is_ignored():
    assembly = Assembly(LIMIT)
    for number in range(MAX_INCOMPLETE):
        assembly.add(fragment(0, 2, fragment_id=number), 0)
    refused(assembly, fragment(0, 3, fragment_id="one more"))
    assembly.add(fragment(1, 2, fragment_id=0), 0)
    for num in (1, 2):
        assert assembly.add(fragment(num, 3, fragment_id="one more"), 0) is None
    assert len(assembly) == MAX_INCOMPLETE - 1


def test_the_rest_of_a_message_that_took_too_long_is_ignored():
    assembly = Assembly(LIMIT)
    assembly.add(fragment(0, 2), 0)
    assembly.expire(MAX_AGE_NS + 1)
    assert assembly.add(fragment(1, 2), MAX_AGE_NS + 2) is None
    assert len(assembly) == 0


@pytest.mark.parametrize("total", [2, 3])
def test_a_refused_message_may_be_sent_again_smaller(total):
    assembly = Assembly(LIMIT)
    refused(assembly, fragment(0, 3, "x" * (LIMIT + 1)))
    for num in range(total - 1):
        assert assembly.add(fragment(num, total, "x"), 0) is None
    assert assembly.add(fragment(total - 1, total, "x"), 0) == b"x" * total


def test_a_refused_message_is_forgotten_in_time_and_when_there_are_many():
    assembly = Assembly(LIMIT)
    for fragment_id in range(5):  # one more than are remembered
        refused(assembly, fragment(0, 2, "x" * (LIMIT + 1), fragment_id))
    for fragment_id, now_ns in ((0, 0), (1, MAX_AGE_NS + 1)):
        assembly.add(fragment(1, 2, "x", fragment_id), now_ns)
        assert assembly.add(fragment(0, 2, "x", fragment_id), now_ns) == b"xx"


def test_a_refused_message_all_of_which_has_come_takes_no_place():
    assembly = Assembly(LIMIT)
    too_large = "x" * (LIMIT + 1)
    refused(assembly, fragment(0, 2, too_large, "still to come"))
    refused(assembly, fragment(0, 2, too_large, "complete"))
    assembly.add(fragment(1, 2, "x", "complete"), 0)
    for number in range(3):
        refused(assembly, fragment(0, 2, too_large, number))
    assembly.add(fragment(1, 2, "x", "still to come"), 0)
    assert len(assembly) == 0


def test_a_whole_message_may_be_as_large_as_the_limit():
    assembly = Assembly(LIMIT)
    assembly.add(fragment(0, 2, "x" * 500), 0)
    assert assembly.add(fragment(1, 2, "x" * 500), 0) == b"x" * LIMIT


def test_incomplete_messages_are_together_as_large_as_the_limit():
    assembly = Assembly(LIMIT)
    assembly.add(fragment(0, 2, "x" * 600, "one"), 0)
    code, text = refused(assembly, fragment(0, 2, "y" * 401, "other"))
    assert (code, text) == (
        "limit_exceeded",
        f"data: 1001 bytes so far, {TOO_LARGE}",
    )
    assert assembly.add(fragment(1, 2, "x" * 400, "one"), 0) == b"x" * LIMIT


def test_too_many_pieces_are_refused():
    assembly = Assembly(LIMIT)
    assembly.add(fragment(0, MAX_PIECES), 0)
    code, text = refused(assembly, fragment(0, MAX_PIECES + 1, fragment_id="other"))
    assert (code, text) == ("limit_exceeded", "total: 4097, at most 4096 allowed")


def test_too_many_incomplete_messages_are_refused():
    assembly = Assembly(LIMIT)
    for number in range(MAX_INCOMPLETE):
        assembly.add(fragment(0, 2, fragment_id=number), 0)
    code, _ = refused(assembly, fragment(0, 2, fragment_id="one more"))
    assert code == "limit_exceeded"
    assert assembly.add(fragment(1, 2, fragment_id=0), 0) == b"xx"
    assembly.add(fragment(0, 2, fragment_id="one more"), 0)


def test_a_message_that_takes_too_long_is_forgotten():
    assembly = Assembly(LIMIT)
    assembly.add(fragment(0, 3, fragment_id="old"), 0)
    assembly.add(fragment(0, 2, fragment_id="new"), 1)
    assert assembly.expire(MAX_AGE_NS) == []
    expected = [("old", "1 of 3 pieces came within 60 s")]
    assert assembly.expire(MAX_AGE_NS + 1) == expected
    assert assembly.expire(MAX_AGE_NS + 1) == []
    assert assembly.add(fragment(1, 2, fragment_id="new"), MAX_AGE_NS + 1) == b"xx"


def test_many_pieces_are_assembled():
    pieces = pieces_of("".join(map(str, range(3000))), 3)
    random.Random(0).shuffle(pieces)
    assembly = Assembly(1 << 20)
    assert [whole for piece in pieces if (whole := assembly.add(piece, 0)) is not None] == [
        "".join(map(str, range(3000))).encode()
    ]
