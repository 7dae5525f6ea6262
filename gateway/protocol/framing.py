# SPDX-License-Identifier: Apache-2.0
"""WebSocket frame headers for what the server sends (RFC 6455, section 5.2).

A rendition is framed once and its bytes are shared by all clients, which a WebSocket library
cannot do for us: it frames per connection. Frames from a server are not masked, and nothing
is ever fragmented or compressed, so a header depends on the payload's length alone.
"""

from typing import Final

_FIN_TEXT: Final = 0x81
_SHORT: Final = 126  # lengths below stand in the second byte itself
_LONG: Final = 1 << 16


def text_header(length: int) -> bytes:
    """Return the header of a complete, unmasked text frame with *length* bytes of payload."""
    if length < _SHORT:
        return bytes((_FIN_TEXT, length))
    if length < _LONG:
        return bytes((_FIN_TEXT, 126)) + length.to_bytes(2, "big")
    return bytes((_FIN_TEXT, 127)) + length.to_bytes(8, "big")


def text_frame(payload: bytes) -> bytes:
    """Return a complete, unmasked text frame."""
    return text_header(len(payload)) + payload
