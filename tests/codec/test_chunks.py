# SPDX-License-Identifier: Apache-2.0
from gateway.codec.chunks import Chunks


def test_pieces_are_as_long_as_the_bytes_that_they_amount_to():
    pieces = Chunks.of([b"one", memoryview(b"two")])
    assert (len(pieces), bytes(pieces)) == (6, b"onetwo")


def test_a_part_of_other_bytes_is_not_copied():
    inner = b"x" * 100
    framed = Chunks.of([inner]).within(b"[", b"]")
    assert framed.parts[1] is inner
    assert (len(framed), bytes(framed)) == (102, b"[" + inner + b"]")
