# SPDX-License-Identifier: Apache-2.0
import tracemalloc

from hypothesis import example, given
from hypothesis import strategies as st

from gateway.codec.json import invalid_at

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
