# SPDX-License-Identifier: Apache-2.0
"""The bounds of what a JSON text says, checked before it is parsed.

Parsing takes memory and time for what a text says, so that is counted first. The contents of
strings do not matter, so only the outline of a text is counted, which numpy makes of all characters
at once. A text of 10 MiB may not take longer to count than to parse.
"""

from collections.abc import Generator
from dataclasses import dataclass, field
from typing import Final

import numpy as np
import numpy.typing as npt

from gateway.codec.error_text import JsonError

# An image of 100 kB as an array of numbers. As Python objects about 6 MB.
MAX_ITEMS: Final = 100_000
# On its way to CDR an object costs five times as much as a number: 10 ms for so many points.
MAX_CONTAINERS: Final = 20_000
# A path of 3,000 poses has 48,000. To read and compare as many names takes 12 ms.
MAX_STRINGS: Final = 60_000

MAX_COST: Final = 13_000_000
"""The most that a text may cost: each byte of it costs 1, and what takes longer to read, more."""
# As so many bytes of a long string take as long to read, in addition to its own.
OUTSIDE_COST: Final = 4  # a character outside of strings, of a number or white space
STRING_COST: Final = 80
BACKSLASH_COST: Final = 28
WIDE_COST: Final = 2
"""Of each byte if one is not ASCII: a string takes up to four times its length in memory then."""

Octets = npt.NDArray[np.uint8]
Flags = npt.NDArray[np.bool_]
Places = npt.NDArray[np.intp]

CHUNK_BYTES: Final = 256 * 1024  # looked at in half a millisecond
MIN_ARRAY_BYTES: Final = 16 * 1024
"""An array of numbers with a longer text is read in slices, and its numbers are not items."""

_WORD_BITS: Final = 64
_ALL_INSIDE: Final = np.uint64(2**_WORD_BITS - 1)


@dataclass(slots=True)
class Outline:
    """The counts of what a JSON text says, outside of its strings."""

    containers: int = 0
    empty: int = 0  # of these
    commas: int = 0
    colons: int = 0
    strings: int = 0
    arrays: list[tuple[int, int]] = field(default_factory=list)
    """The places of the elements of long arrays of numbers. They are counted nowhere."""

    @property
    def items(self) -> int:
        """The number of members and elements."""
        # each follows a comma or is first in its container
        return self.commas + self.containers - self.empty


def outline(data: bytes, max_items: int, *, takes_arrays: bool) -> Generator[None, None, Outline]:
    """Return the outline of a text, piece by piece.

    Raises:
        JsonError: it has too many items, objects or strings, or would take too long to read.
    """
    scan = _Scan(data, takes_arrays=takes_arrays)
    for start in range(0, len(data), CHUNK_BYTES):
        if start:
            yield
        scan.look_at(start, min(start + CHUNK_BYTES, len(data)))
        scan.check()
    if scan.found.items > max_items:
        raise JsonError(
            f"JSON has over {max_items} items; send fewer, or raise limits.max_json_items"
        )
    return scan.found


def count_names(data: bytes) -> int:
    """Return how many names a text has: a colon follows each."""
    scan = _Scan(data, takes_arrays=False)
    for start in range(0, len(data), CHUNK_BYTES):
        scan.look_at(start, min(start + CHUNK_BYTES, len(data)))
    return scan.found.colons


class _Scan:
    """The state between two pieces of a text."""

    def __init__(self, data: bytes, *, takes_arrays: bool) -> None:
        self.found = Outline()
        self._data = data
        self._octets: Octets = np.frombuffer(data, np.uint8)
        self._takes_arrays = takes_arrays
        self._end = 0
        self._last: Places = np.empty(0, np.intp)  # the place of the last bracket or quote
        self._is_inside = False  # a string
        self._is_escaped = False  # the next character
        self._is_wide = not data.isascii()
        self._quotes = 0
        self._backslashes = 0
        self._outside = 0  # characters

    def look_at(self, start: int, end: int) -> None:
        """Count what is in the next piece."""
        self._end = end
        octets = self._octets[start:end]
        is_quote: Flags = octets == ord('"')
        if self._is_escaped or self._data.find(b"\\", start, end) >= 0:
            self._look_at_escapes(octets, is_quote, start)
        quotes = int(np.count_nonzero(is_quote))
        if self._is_inside and not quotes:
            return
        # square brackets differ from the others by one bit
        folded = octets | np.uint8(0x20)
        is_open, is_close = folded == ord("{"), folded == ord("}")
        is_comma, is_colon = octets == ord(","), octets == ord(":")
        if quotes or self._is_inside:
            is_outside = _outside_of_strings(is_quote, self._is_inside)
            self._is_inside ^= bool(quotes % 2)
            self._outside += int(np.count_nonzero(is_outside))
            for flags in (is_open, is_close, is_comma, is_colon):
                flags &= is_outside
        else:
            self._outside += len(octets)
        found = self.found
        self._quotes += quotes
        found.strings = self._quotes // 2
        found.containers += int(np.count_nonzero(is_open))
        found.commas += int(np.count_nonzero(is_comma))
        found.colons += int(np.count_nonzero(is_colon))
        places: Places = np.flatnonzero(is_open | is_close | is_quote) + start
        places = np.concatenate((self._last, places))
        self._last = places[-1:]
        self._count_empty(places)
        if self._takes_arrays:
            self._find_arrays(places)

    def check(self) -> None:
        """Raise `JsonError` if that is too much."""
        found = self.found
        if found.containers > MAX_CONTAINERS:
            raise JsonError(
                f"JSON has over {MAX_CONTAINERS} objects and arrays; send fewer at once"
            )
        if found.strings > MAX_STRINGS:
            raise JsonError(
                f"JSON has over {MAX_STRINGS} strings, names included; send fewer at once"
            )
        size, outside = len(self._data), self._outside
        may_be_array = self._takes_arrays and self._end < size  # else nothing closes it
        if may_be_array and self._last.size and self._octets[self._last[0]] == ord("["):
            outside -= self._end - int(self._last[0]) - 1
        costs = {
            "characters that are not ASCII": WIDE_COST * size if self._is_wide else 0,
            "backslashes": BACKSLASH_COST * self._backslashes,
            "strings": STRING_COST * found.strings,
            "numbers and white space": OUTSIDE_COST * outside,
        }
        if size + sum(costs.values()) > MAX_COST:
            most = "length" if size > MAX_COST else max(costs, key=costs.__getitem__)
            text = f"JSON of {size} bytes takes too long to read, for its {most}"
            raise JsonError(f"{text}; send it in parts, or as CBOR")

    def _look_at_escapes(self, octets: Octets, is_quote: Flags, start: int) -> None:
        """Note what stands behind a backslash that is not escaped itself: it ends no string."""
        is_backslash: Flags = octets == ord("\\")
        self._backslashes += int(np.count_nonzero(is_backslash))
        if self._is_escaped:
            is_backslash[0] = False
        places = _escaped(is_backslash)
        if self._is_escaped:
            places = np.concatenate((np.zeros(1, np.intp), places))
        self._is_escaped = bool(places.size) and int(places[-1]) == len(octets)
        if self._is_escaped:
            places = places[:-1]
        is_quote[places] = False
        self._is_wide = self._is_wide or _has_wide(self._octets, places + start)

    def _count_empty(self, places: Places) -> None:
        marks = self._octets[places] | np.uint8(0x20)
        is_pair = (marks[:-1] == ord("{")) & (marks[1:] == ord("}"))
        self.found.empty += int(np.count_nonzero(is_pair & (np.diff(places) == 1)))

    def _find_arrays(self, places: Places) -> None:
        """Find long arrays that hold no string, object or array."""
        for index in np.flatnonzero(np.diff(places) - 1 > MIN_ARRAY_BYTES).tolist():
            start, end = int(places[index]) + 1, int(places[index + 1])
            if self._octets[start - 1] == ord("[") and self._octets[end] == ord("]"):
                self.found.arrays.append((start, end))
                self._outside -= end - start
                self.found.commas -= int(np.count_nonzero(self._octets[start:end] == ord(",")))


def _escaped(is_backslash: Flags) -> Places:
    """Return where the characters behind a backslash are that is not escaped itself."""
    backslashes: Places = np.flatnonzero(is_backslash)
    is_first = np.diff(backslashes, prepend=-2) > 1
    if not is_first.all():  # of those in a row each second one is escaped
        first = backslashes[is_first][np.cumsum(is_first) - 1]
        backslashes = backslashes[(backslashes - first) & 1 == 0]
    return backslashes + 1


def _has_wide(octets: Octets, escaped: Places) -> bool:
    r"""Return whether characters beyond U+00FF are escaped. ``\u003d`` is how some write ``=``."""
    codes = escaped[octets[escaped] == ord("u")]
    codes = codes[codes < len(octets) - 2]
    is_narrow = (octets[codes + 1] == ord("0")) & (octets[codes + 2] == ord("0"))
    return not is_narrow.all()


def _outside_of_strings(is_quote: Flags, was_inside: bool) -> Flags:  # a state
    """Return which characters are outside, as the quote that ends a string is.

    A bit says whether a character is within a string, by the number of quotes before it. It is the
    exclusive or of all bits up to it, 64 at a time, as in simdjson (Langdale and Lemire, Parsing
    Gigabytes of JSON per Second, 2019, section 3.1.1).
    """
    is_inside = np.zeros(-(-len(is_quote) // _WORD_BITS), "<u8")
    packed = np.packbits(is_quote, bitorder="little")
    is_inside.view(np.uint8)[: len(packed)] = packed
    for shift in (1, 2, 4, 8, 16, 32):
        is_inside ^= is_inside << np.uint64(shift)
    is_open = is_inside >> np.uint64(_WORD_BITS - 1)  # a string, at the end of each word
    was_open = np.bitwise_xor.accumulate(is_open) ^ is_open ^ np.uint64(was_inside)  # before it
    is_inside ^= was_open * _ALL_INSIDE
    bits = np.unpackbits((~is_inside).view(np.uint8), bitorder="little", count=len(is_quote))
    return bits.view(np.bool_)
