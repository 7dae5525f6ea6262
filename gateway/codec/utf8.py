# SPDX-License-Identifier: Apache-2.0
"""A check that a text from a client is UTF-8."""

import codecs
from typing import Final

_PIECE_BYTES: Final = 64 * 1024  # decoded at once: the rest needs no memory


def invalid_at(data: bytes) -> int | None:
    """Return the offset of the first octet that is not UTF-8 (RFC 3629), or ``None``."""
    if data.isascii():
        return None
    decoder = codecs.getincrementaldecoder("utf-8")()
    for start in range(0, len(data), _PIECE_BYTES):
        held, _ = decoder.getstate()  # of a character that the piece before has begun
        end = start + _PIECE_BYTES
        try:
            decoder.decode(data[start:end], final=end >= len(data))
        except UnicodeDecodeError as error:
            return start - len(held) + error.start
    return None
