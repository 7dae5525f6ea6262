# SPDX-License-Identifier: Apache-2.0
"""Bytes that are too many to be copied: pieces in a row, which nobody joins."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TypeAlias

Chunk: TypeAlias = bytes | memoryview
"""Bytes, or a view of some, with one byte for each element."""


@dataclass(frozen=True, slots=True)
class Chunks:
    """A text, an item of CBOR or a frame, in pieces. Its length is that of all of them."""

    parts: tuple[Chunk, ...]
    size: int

    @classmethod
    def of(cls, parts: Iterable[Chunk]) -> "Chunks":
        """Take pieces as they are."""
        known = tuple(parts)
        return cls(known, sum(map(len, known)))

    def __len__(self) -> int:
        """Return the number of bytes."""
        return self.size

    def __bytes__(self) -> bytes:
        """Join them, which takes a millisecond for some MB."""
        return b"".join(self.parts)

    def within(self, before: bytes, after: bytes) -> "Chunks":
        """Return them with more before and after. Nothing is copied."""
        return Chunks((before, *self.parts, after), len(before) + self.size + len(after))
