# SPDX-License-Identifier: Apache-2.0
"""Changes of bytes as a fuzzer makes them, but the same each time."""

import random
from collections.abc import Iterator, Sequence

MAX_CHANGES = 4
MAX_BYTES = 4096
RANDOM_BYTES = 200
TELLING = (
    *(b"\0", b"\xff", b"\x7f\xff\xff\xff", b"\xff\xff\xff\xff", b"\0\0\0\x80", b"\0" * 8),
    *(b'"', b"\\", b"{", b"}", b"[", b"]", b",", b":", b"null", b"true", b"1e999", b"-1"),
    *(b"\\u0000", b"\\ud800", b"\xed\xa0\x80", b"\xf0\x9f\xa4\x96", b"\r\n", b"\n", b"/", b"**"),
)


def mutations(seeds: Sequence[bytes], count: int, number: int) -> Iterator[bytes]:
    """Return *count* changed seeds, those of that number."""
    chance = random.Random(number)
    for number_of_change in range(count):
        data = chance.choice(seeds)
        if number_of_change % 4 == 0:  # decisions made by chance
            data = data[:3] + chance.randbytes(chance.randint(0, RANDOM_BYTES))
        for _ in range(chance.randint(1, MAX_CHANGES)):
            data = _changed(data, seeds, chance)
        yield data[:MAX_BYTES]


def _changed(data: bytes, seeds: Sequence[bytes], chance: random.Random) -> bytes:
    start = chance.randint(0, len(data))
    end = min(len(data), start + chance.choice((0, 1, 1, 2, 4, 8, 64)))
    match chance.randrange(6):
        case 0:
            replaced = chance.choice(TELLING)
        case 1:
            replaced = chance.randbytes(end - start)
        case 2:
            replaced = b""
        case 3:
            replaced = data[start:end] * chance.randint(2, 5)
        case 4:
            other = chance.choice(seeds)
            at = chance.randint(0, len(other))
            replaced = other[at : at + 64]
        case _:
            replaced = bytes(octet ^ 1 << chance.randrange(8) for octet in data[start:end])
    return data[:start] + replaced + data[end:]
