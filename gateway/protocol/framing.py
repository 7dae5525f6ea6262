# SPDX-License-Identifier: Apache-2.0
"""WebSocket frame headers for what the server sends (RFC 6455, section 5.2).

A rendition is framed once and its bytes are shared by all clients, which a WebSocket library
cannot do for us: it frames per connection. Frames from a server are not masked, and none is
fragmented or compressed, so a header depends on the payload's kind and length alone.
"""

from typing import Final

_FIN_TEXT: Final = 0x81
_FIN_BINARY: Final = 0x82
_SHORT: Final = 126  # lengths below stand in the second byte itself
_LONG: Final = 1 << 16


def text_header(length: int) -> bytes:
    """Return the header of a complete, unmasked text frame with *length* bytes of payload."""
    return _header(_FIN_TEXT, length)


def binary_header(length: int) -> bytes:
    """Return the header of a complete, unmasked binary frame with *length* bytes of payload."""
    return _header(_FIN_BINARY, length)


def text_frame(payload: bytes) -> bytes:
    """Return a complete, unmasked text frame."""
    return text_header(len(payload)) + payload


def payload_offset(frame: bytes) -> int:
    """Return where the payload begins in an unmasked frame."""
    return {126: 4, 127: 10}.get(frame[1], 2)


def _header(first: int, length: int) -> bytes:
    if length < _SHORT:
        return bytes((first, length))
    if length < _LONG:
        return bytes((first, 126)) + length.to_bytes(2, "big")
    return bytes((first, 127)) + length.to_bytes(8, "big")
