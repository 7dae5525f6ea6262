# SPDX-License-Identifier: Apache-2.0
"""Arrays of messages or strings in large messages: a few elements are decoded, and then written.

As Python objects a million elements would take a hundred times their bytes, and garbage collection
would look at each.
"""

from collections.abc import Generator, Iterator
from itertools import islice
from typing import Final

from typing_extensions import Self

from gateway.codec.json_slices import Write, WrittenArray, element_slices

# Decoded before they are written: about 0.1 ms.
CHUNK_ELEMENTS: Final = 64


class JsonElements(WrittenArray):
    """Elements as JSON."""

    def __init__(self, write: Write) -> None:
        super().__init__()
        self._write = write
        self._few: list[object] = []
        self._opening = b"["

    def add(self, element: object) -> bool:
        """Take one. Return whether it is time to write."""
        self._few.append(element)
        return len(self._few) >= CHUNK_ELEMENTS

    def take(self, elements: Iterator[object]) -> Generator[bytes, None, Self]:
        """Take and write all of them. Pause now and then, and return this."""
        while few := list(islice(elements, CHUNK_ELEMENTS)):
            self._few = few
            yield from self.write()
        yield from self.end()
        return self

    def write(self) -> Iterator[bytes]:
        """Write those that were taken."""
        few, self._few = self._few, []
        for text in element_slices(few, self._write, self._opening):
            self.parts.append(text)
            self._opening = b","
            yield b""

    def end(self) -> Iterator[bytes]:
        """Write what is left."""
        yield from self.write()
        self.parts.append(b"]" if self.parts else b"[]")


class CborElements:
    """Elements as CBOR, without the head of their array."""

    def __init__(self) -> None:
        self.count = 0
        self.parts: list[bytes] = []
        self._few: list[bytes] = []

    def add(self, element: bytes) -> bool:
        """Take one. Return whether it is time to write."""
        self._few.append(element)
        return len(self._few) >= CHUNK_ELEMENTS

    def take(self, elements: Iterator[bytes]) -> Generator[bytes, None, Self]:
        """Take and write all of them. Pause now and then, and return this."""
        while few := list(islice(elements, CHUNK_ELEMENTS)):
            self._few = few
            yield from self.write()
        return self

    def write(self) -> Iterator[bytes]:
        """Join those that were taken."""
        few, self._few = self._few, []
        self.count += len(few)
        self.parts.append(b"".join(few))
        yield b""

    def end(self) -> Iterator[bytes]:
        """Join what is left."""
        yield from self.write()
