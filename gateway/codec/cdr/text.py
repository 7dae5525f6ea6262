# SPDX-License-Identifier: Apache-2.0
"""Strings in CDR."""

import numpy as np

from gateway.codec.cdr.layout import ByteOrder


def to_cdr(text: str, *, is_wide: bool) -> tuple[int, bytes]:
    """Return the count that precedes a string, and its octets. Only a narrow one ends with NUL."""
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


def wide_text(units: bytes, order: ByteOrder) -> str:
    """Read UTF-16 units of 4 bytes each, as Fast CDR writes a wstring."""
    narrow = np.frombuffer(units, f"{order}u4").astype("<u2")
    return narrow.tobytes().decode("utf-16-le", "replace")
