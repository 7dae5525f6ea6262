# SPDX-License-Identifier: Apache-2.0
"""The bounds of what a JSON text says, checked before it is parsed.

Parsing takes memory and time for what a text says, so that is bounded first. What strings hold says
nothing: which characters are theirs is told from the quotes, all at once by numpy, as a text of
10 MiB may not take longer to look at than to parse.
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
# 2 ms to tell which of them escape a quote. The robot's description with most has some 10,000.
MAX_BACKSLASHES: Final = 128 * 1024

# One character beyond U+00FF, and the whole string takes up to four times its length in memory, and
# three times as long.
MAX_WIDE_BYTES: Final = 4 * 1024 * 1024

LARGE_BYTES: Final = 256 * 1024
"""From here on a text is looked at without its long strings, those of images."""
_LONG_STRING: Final = 2048  # bytes; 5,000 of them fill a text, and cutting them out takes 2 ms
# For each item that a large text may have, long strings left out: a number of 17 digits and some
# white space. What takes longest to look at takes 6 ms.
SHORT_BYTES: Final = 24

Octets = npt.NDArray[np.uint8]
Flags = npt.NDArray[np.bool_]
Places = npt.NDArray[np.intp]


def check(text: bytes, max_items: int) -> None:
    """Raise `JsonError` if a text has more than *max_items*, or more than any may have."""
    octets = np.frombuffer(text, np.uint8)
    is_quote = _quotes(octets, _escaped(octets))
    if _containers(octets) <= MAX_CONTAINERS and _items_at_most(octets) <= max_items:
        return
    outside = _outside_of_strings(octets, is_quote)
    empty = bytes(outside).count(b"[]") + bytes(outside).count(b"{}")
    if _items_at_most(outside) - empty > max_items:
        raise JsonError(f"JSON has over {max_items} items")
    if _containers(outside) > MAX_CONTAINERS:
        raise JsonError(f"JSON has over {MAX_CONTAINERS} objects and arrays")


def without_long_strings(data: bytes, max_items: int) -> bytes:
    """Return a large text with nothing in its long strings.

    Raises:
        JsonError: there is too much beside them, there are too many backslashes, or the text has
            over `MAX_WIDE_BYTES` and is not ASCII.
    """
    octets = np.frombuffer(data, np.uint8)
    escaped = _escaped(octets)
    may_be_wide = not data.isascii() or (octets[escaped] == ord("u")).any()
    if may_be_wide and len(data) > MAX_WIDE_BYTES:
        limit = f"JSON of over {MAX_WIDE_BYTES // 1024**2} MiB"
        raise JsonError(f"{limit} has a character that is not ASCII, or one written as \\u")
    quotes = np.flatnonzero(_quotes(octets, escaped))
    strings = quotes[: len(quotes) // 2 * 2].reshape(-1, 2)  # where each begins and ends
    pieces = []
    start = 0
    for opening, closing in strings[strings[:, 1] - strings[:, 0] > _LONG_STRING].tolist():
        pieces.append(data[start : opening + 1])
        start = closing
    text = b"".join([*pieces, data[start:]])
    most = max(LARGE_BYTES, SHORT_BYTES * max_items)
    if len(text) > most:
        long = f"strings of over {_LONG_STRING // 1024} KiB"
        raise JsonError(f"JSON has over {most} bytes, those in {long} left out")
    return text


def count_names(text: bytes) -> int:
    """Count the names in a text that is JSON: a colon outside of strings follows each."""
    octets = np.frombuffer(text, np.uint8)
    outside = _outside_of_strings(octets, _quotes(octets, _escaped(octets)))
    return int(np.count_nonzero(outside == ord(":")))


def _quotes(octets: Octets, escaped: Places) -> Flags:
    """Return which characters begin or end a string."""
    is_quote: Flags = octets == ord('"')
    is_quote[escaped] = False
    if np.count_nonzero(is_quote) // 2 > MAX_STRINGS:
        raise JsonError(f"JSON has over {MAX_STRINGS} strings, names included")
    return is_quote


def _escaped(octets: Octets) -> Places:
    """Return where the characters behind a backslash are that is not escaped itself."""
    is_backslash = octets[:-1] == ord("\\")
    if np.count_nonzero(is_backslash) > MAX_BACKSLASHES:
        raise JsonError(f"JSON has over {MAX_BACKSLASHES} backslashes")
    backslashes: Places = np.flatnonzero(is_backslash)
    is_first = np.diff(backslashes, prepend=-2) > 1  # of those in a row each second one is escaped
    first = backslashes[is_first][np.cumsum(is_first) - 1]
    escaping: Places = backslashes[(backslashes - first) % 2 == 0]
    return escaping + 1


def _outside_of_strings(octets: Octets, is_quote: Flags) -> Octets:
    """Return the characters, with 0 for an opening quote and all up to the closing one."""
    is_inside = np.bitwise_xor.accumulate(is_quote.view(np.uint8))
    outside: Octets = octets & (is_inside - 1)
    return outside


def _containers(octets: Octets) -> int:
    is_opening = (octets | 0x20) == ord("{")  # or a square bracket, which differs by that bit
    return int(np.count_nonzero(is_opening))


def _items_at_most(octets: Octets) -> int:
    """Return an upper bound of the items: each follows a comma or is first in its container."""
    return int(np.count_nonzero(octets == ord(","))) + _containers(octets)
