# SPDX-License-Identifier: Apache-2.0
"""Messages in pieces: in any order, twice, contradictory, never complete."""

from gateway.core.errors import ProtocolError
from gateway.fronts.rosbridge.fragments import (
    MAX_AGE_NS,
    MAX_INCOMPLETE,
    MAX_PIECES,
    MAX_REFUSED,
    Assembly,
)
from gateway.fronts.rosbridge.operations.fragment import Fragment
from tests.fuzz.choices import Choices
from tests.fuzz.target import Target, check

MAX_BYTES = 64
SIZES = (0, 1, 2, 3, 4, MAX_PIECES, MAX_PIECES + 1, 2**62)


def run(data: bytes) -> None:
    """Send pieces, and keep account of those that are accepted."""
    choices = Choices(data)
    assembly = Assembly(MAX_BYTES)
    now_ns = 0
    while not choices.is_over:
        now_ns += choices.pick((0, 1, MAX_AGE_NS // 2, MAX_AGE_NS + 1))
        if choices.happens(16):
            assembly.expire(now_ns)
        fragment = Fragment.model_validate(
            {
                "op": "fragment",
                "id": choices.pick(("a", "b", "c", "d", "e", 1, "1")),
                "num": choices.pick(SIZES),
                "total": max(1, choices.pick(SIZES)),
                "data": choices.take(choices.below(24)).decode("utf-8", "replace"),
            }
        )
        before = assembly._incomplete.get(fragment.id)
        pieces = dict(before.pieces) if before else {}
        try:
            whole = assembly.add(fragment, now_ns)
        except ProtocolError as error:
            check(error.code in {"bad_request", "limit_exceeded"})
            whole = None
        if whole is not None:
            pieces.setdefault(fragment.num, fragment.data)
            check(len(pieces) == fragment.total, "complete without all of its pieces")
            expected = "".join(pieces[number] for number in range(fragment.total)).encode()
            check(whole == expected, "joined in another order")
            check(fragment.id not in assembly._incomplete)
        kept = sum(
            len(piece.encode())
            for message in assembly._incomplete.values()
            for piece in message.pieces.values()
        )
        check(kept <= MAX_BYTES, "keeps more than it may", kept)
        check(len(assembly) <= MAX_INCOMPLETE)
        check(len(assembly._refused) <= MAX_REFUSED)
        check(all(each.missing for each in assembly._refused.values()))
        check(all(len(each.missing) <= MAX_PIECES for each in assembly._refused.values()))


def piece(number_of_id: int, number: int, number_of_total: int, size: int) -> bytes:
    return bytes((0, 0, number_of_id, number, number_of_total, size)) + b"a" * size


def corpus() -> list[bytes]:
    return [
        b"\x00\x00\x00\x01\x02\x05hello" + b"\x00\x00\x00\x00\x02\x02hi",
        b"".join(piece(id_, 0, 2, 3) for id_ in range(6)),
        b"".join(piece(0, number, 4, 23) for number in range(4)),
        b"".join(piece(id_, 0, 5, 23) + piece(id_, 1, 5, 23) for id_ in range(7)),
        b"".join(piece(id_, 0, 5, 20) for id_ in (*range(7), *range(7), *range(7))),
        b"\x00\x00\x00\x00\x02\x17" + b"a" * 23 + b"\x03\xff\x00\x01\x02\x01b",
    ]


TARGET = Target("pieces are joined in their order, within the limits", run, corpus)
