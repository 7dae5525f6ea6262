# SPDX-License-Identifier: Apache-2.0
"""Decisions made of bytes, so that a fuzzer that changes bytes changes decisions."""

import struct
from collections.abc import Sequence
from typing import TypeVar

T = TypeVar("T")

EDGES = (0, 1, -1, 127, 128, 255, 256, -128, -129, 2**15, 2**16, 2**31 - 1, 2**31, -(2**31), 2**32)
LARGE_EDGES = (2**53, 2**63 - 1, 2**63, -(2**63), -(2**63) - 1, 2**64 - 1, 2**64, 10**30)


class Choices:
    """Takes bytes from the front. If none are left, each decision is the first and least."""

    def __init__(self, data: bytes) -> None:
        self._data = data
        self._at = 0

    @property
    def is_over(self) -> bool:
        return self._at >= len(self._data)

    def take(self, count: int) -> bytes:
        taken = self._data[self._at : self._at + count]
        self._at += count
        return taken

    def rest(self) -> bytes:
        return self.take(len(self._data))

    def byte(self) -> int:
        taken = self.take(1)
        return taken[0] if taken else 0

    def below(self, limit: int) -> int:
        if limit <= 256:
            return self.byte() % max(limit, 1)
        return int.from_bytes(self.take(4), "little") % limit

    def pick(self, options: Sequence[T]) -> T:
        return options[self.below(len(options))]

    def happens(self, in_256: int) -> bool:
        """Return true for that many of 256 bytes, and not for a missing one."""
        return self.byte() > 255 - in_256

    def octets(self) -> bytes:
        return self.take(self.byte())

    def text(self) -> str:
        return self.octets().decode("utf-8", "replace")

    def integer(self) -> int:
        match self.byte() % 4:
            case 0:
                return self.byte()
            case 1:
                return self.pick(EDGES)
            case 2:
                return self.pick(LARGE_EDGES)
        return int.from_bytes(self.take(8), "little", signed=True)

    def number(self) -> float:
        taken = self.take(8).ljust(8, b"\0")
        found: float = struct.unpack("<d", taken)[0]
        return found
