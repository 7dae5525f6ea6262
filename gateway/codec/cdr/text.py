# SPDX-License-Identifier: Apache-2.0
"""Strings in CDR."""

import numpy as np


def to_cdr(text: str, *, is_wide: bool) -> tuple[int, bytes]:
    """Return the count that precedes a string, and its octets; only a narrow one ends with NUL."""
    octets = wide(text) if is_wide else text.encode() + b"\0"
    return len(octets) // (4 if is_wide else 1), octets


def wide(text: str) -> bytes:
    """Encode as UTF-16 units of 4 bytes each, as Fast CDR does for a wstring.

    Raises:
        ValueError: it has a lone surrogate, or U+0000, which would end it for its readers.
    """
    if "\0" in text:
        raise ValueError("U+0000 in a string")
    return np.frombuffer(text.encode("utf-16-le"), "<u2").astype("<u4").tobytes()
