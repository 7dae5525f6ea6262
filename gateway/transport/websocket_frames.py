# SPDX-License-Identifier: Apache-2.0
"""The WebSocket frames that the gateway sends (RFC 6455, section 5.2).

Frames from a server are not masked, and none is fragmented or compressed, so a header depends on
the payload's kind and length alone.
"""

import struct
from typing import Final

# the first byte of a complete frame: FIN, and the opcode
TEXT: Final = 0x81
BINARY: Final = 0x82

_SHORT: Final = 126  # a shorter length stands in the second byte itself
_LONG: Final = 1 << 16
_pack_short: Final = struct.Struct(">BB").pack
_pack_medium: Final = struct.Struct(">BBH").pack
_pack_long: Final = struct.Struct(">BBQ").pack


def header(kind: int, length: int) -> bytes:
    """Return the header of a complete, unmasked frame of `TEXT` or `BINARY`.

    *length* is that of the payload in bytes.
    """
    if length < _SHORT:
        return _pack_short(kind, length)
    if length < _LONG:
        return _pack_medium(kind, 126, length)
    return _pack_long(kind, 127, length)


def payload(frame: bytes) -> bytes:
    """Take the payload out of a single frame of ours."""
    return frame[payload_offset(frame) :]


def text_frame(payload: bytes) -> bytes:
    """Return a complete, unmasked text frame."""
    return header(TEXT, len(payload)) + payload


def payload_offset(frame: bytes) -> int:
    """Return where the payload of a single frame of ours begins."""
    return {126: 4, 127: 10}.get(frame[1], 2)
