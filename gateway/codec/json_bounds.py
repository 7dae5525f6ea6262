# SPDX-License-Identifier: Apache-2.0
"""The bounds of what a JSON text says, checked before it is parsed.

Parsing takes memory and time for what a text says, so that is counted first. What strings hold says
nothing, so it is the outline of a text that is looked at, which numpy makes of all characters at
once: a text of 10 MiB may not take longer to look at than to parse.
"""

from typing import Final

import numpy as np
import numpy.typing as npt

from gateway.codec.errors import JsonError

# An image of 100 kB as an array of numbers; as Python objects about 6 MB.
MAX_ITEMS: Final = 100_000
# On its way to CDR an object costs five times as much as a number: 10 ms for so many points.
MAX_CONTAINERS: Final = 20_000
# A path of 3,000 poses has 48,000. To read and compare as many names takes 12 ms.
MAX_STRINGS: Final = 60_000

MAX_COST: Final = 13_000_000
"""The most that a text may cost: each byte of it costs 1, and what takes longer to read, more."""
# As so many bytes of a long string take as long to read, beside its own.
OUTSIDE_COST: Final = 4  # a character outside of strings, of a number or white space
STRING_COST: Final = 80
BACKSLASH_COST: Final = 28
WIDE_COST: Final = 2
"""Of each byte if one is not ASCII: a string takes up to four times its length in memory then."""

Octets = npt.NDArray[np.uint8]
Flags = npt.NDArray[np.bool_]
Places = npt.NDArray[np.intp]

_WORD_BITS: Final = 64
_ALL_INSIDE: Final = np.uint64(2**_WORD_BITS - 1)


def outline(data: bytes) -> bytes:
    """Return a JSON text with a quote for each of its strings.

    Raises:
        JsonError: there are too many strings, or the text would take too long to read.
    """
    octets = np.frombuffer(data, np.uint8)
    is_quote: Flags = octets == ord('"')
    costs = {"characters that are not ASCII": 0 if data.isascii() else WIDE_COST * len(data)}
    if b"\\" in data:
        is_backslash = octets == ord("\\")
        costs["backslashes"] = BACKSLASH_COST * int(np.count_nonzero(is_backslash))
        _check_cost(len(data), costs)  # or what follows takes too much memory
        escaped = _escaped(is_backslash)
        is_quote[escaped] = False
        if _has_wide(octets, escaped):
            costs["characters that are not ASCII"] = WIDE_COST * len(data)
    strings = int(np.count_nonzero(is_quote)) // 2
    if strings > MAX_STRINGS:
        raise JsonError(f"JSON has over {MAX_STRINGS} strings, names included")
    outside = _outside_of_strings(octets, is_quote)
    costs["strings"] = STRING_COST * strings
    costs["numbers and white space"] = OUTSIDE_COST * len(outside)
    _check_cost(len(data), costs)
    return outside


def check(outline: bytes, max_items: int) -> None:
    """Raise `JsonError` if a text has more items than *max_items*, or too many objects."""
    octets = np.frombuffer(outline, np.uint8)
    # and square brackets, which differ from the others by one bit
    containers = _count(octets | np.uint8(0x20), "{")
    if containers > MAX_CONTAINERS:
        raise JsonError(f"JSON has over {MAX_CONTAINERS} objects and arrays")
    # each follows a comma or is first in its container
    items = _count(octets, ",") + containers
    if items > max_items and items - outline.count(b"[]") - outline.count(b"{}") > max_items:
        raise JsonError(f"JSON has over {max_items} items")


def count_names(outline: bytes) -> int:
    """Return how many names there are: a colon follows each."""
    return _count(np.frombuffer(outline, np.uint8), ":")


def _count(octets: Octets, character: str) -> int:
    return int(np.count_nonzero(octets == ord(character)))  # faster than `bytes.count`


def _check_cost(size: int, costs: dict[str, int]) -> None:
    if size + sum(costs.values()) > MAX_COST:
        most = "length" if size > MAX_COST else max(costs, key=costs.__getitem__)
        text = f"JSON of {size} bytes takes too long to read, for its {most}"
        raise JsonError(f"{text}; send it in parts, or as CBOR")


def _escaped(is_backslash: Flags) -> Places:
    """Return where the characters behind a backslash are that is not escaped itself."""
    backslashes: Places = np.flatnonzero(is_backslash[:-1])
    is_first = np.diff(backslashes, prepend=-2) > 1
    if not is_first.all():  # of those in a row each second one is escaped
        first = backslashes[is_first][np.cumsum(is_first) - 1]
        backslashes = backslashes[(backslashes - first) & 1 == 0]
    return backslashes + 1


def _has_wide(octets: Octets, escaped: Places) -> bool:
    r"""Return whether characters beyond U+00FF are escaped; ``\u003d`` is how some write ``=``."""
    codes = escaped[octets[escaped] == ord("u")]
    codes = codes[codes < len(octets) - 2]
    is_narrow = (octets[codes + 1] == ord("0")) & (octets[codes + 2] == ord("0"))
    return not is_narrow.all()


def _outside_of_strings(octets: Octets, is_quote: Flags) -> bytes:
    """Return the characters that are outside, as the quote that ends a string is.

    A bit says whether so many quotes stand before a character that it is within a string: the
    exclusive or of all bits up to it, 64 at a time (as simdjson does it; Langdale and Lemire,
    Parsing Gigabytes of JSON per Second, 2019, section 3.1.1).
    """
    is_inside = np.zeros(-(-len(octets) // _WORD_BITS), "<u8")
    packed = np.packbits(is_quote, bitorder="little")
    is_inside.view(np.uint8)[: len(packed)] = packed
    for shift in (1, 2, 4, 8, 16, 32):
        is_inside ^= is_inside << np.uint64(shift)
    is_open = is_inside >> np.uint64(_WORD_BITS - 1)  # a string, at the end of each word
    was_open = np.bitwise_xor.accumulate(is_open) ^ is_open  # before it
    is_inside ^= was_open * _ALL_INSIDE
    # most words are within long strings, and the last one may have fewer characters
    last = len(octets) // _WORD_BITS
    words = np.flatnonzero(is_inside[:last] != _ALL_INSIDE)
    rows = octets[: last * _WORD_BITS].reshape(-1, _WORD_BITS)
    outside = rows[words].ravel()[_bits(~is_inside[words])]
    rest = octets[last * _WORD_BITS :]
    return outside.tobytes() + rest[_bits(~is_inside[last:])[: len(rest)]].tobytes()


def _bits(words: npt.NDArray[np.uint64]) -> Flags:
    return np.unpackbits(words.view(np.uint8), bitorder="little").view(np.bool_)
