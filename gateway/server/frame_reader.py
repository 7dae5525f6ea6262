# SPDX-License-Identifier: Apache-2.0
"""The WebSocket frames that a client sends (RFC 6455, section 5.2).

`websockets` reads them, and is ready for bytes that come one by one: 3 us for each in a hot loop.
Nearly all are messages of one frame that are there as a whole; read here they take a third of that.
"""

from collections.abc import Sequence
from typing import Final

from websockets.frames import (  # type: ignore[attr-defined]
    Frame,
    Opcode,
    apply_mask,  # the compiled one, where there is one
)
from websockets.protocol import OPEN, Event
from websockets.server import ServerProtocol

DATA: Final = frozenset({Opcode.TEXT, Opcode.BINARY, Opcode.CONT})

# the first byte of a message in one frame: FIN, no extension, and the opcode
_PLAIN: Final = {0x80 | opcode: opcode for opcode in (Opcode.TEXT, Opcode.BINARY)}

# The second byte: the payload is masked, and has so many bytes, or as the next two or eight say;
# the mask is the end of the head.
_MASKED: Final = 0x80
_MEDIUM: Final = _MASKED | 126
_MASK_LENGTH: Final = 4
_SHORT_HEAD: Final = 2 + _MASK_LENGTH
_MEDIUM_HEAD: Final = 4 + _MASK_LENGTH
_LONG_HEAD: Final = 10 + _MASK_LENGTH


class FrameReader:
    """Reads what one client sends as `websockets` does, to which it leaves all but plain messages.

    What is plain is taken only while `websockets` is between two frames and two messages.
    """

    __slots__ = ("_held_bytes", "_is_in_message", "_protocol")

    def __init__(self, protocol: ServerProtocol) -> None:
        self._protocol = protocol
        # Of a frame that it has begun; never less than it holds, as lengths of frames that it has
        # read count as short as they could be written.
        self._held_bytes = 0
        self._is_in_message = False  # of which more frames come

    def read(self, data: bytes) -> Sequence[Event]:
        """Take the next bytes; return the requests and frames that they complete."""
        if self._protocol.state is not OPEN:
            return self._parse(data)
        if self._held_bytes or self._is_in_message:
            return self._parse_frames(data)
        messages, end = _plain_messages(data, self._protocol.max_message_size)
        return messages if end == len(data) else [*messages, *self._parse_frames(data[end:])]

    def _parse(self, data: bytes) -> list[Event]:
        self._protocol.receive_data(data)
        return self._protocol.events_received()

    def _parse_frames(self, data: bytes) -> list[Event]:
        frames = self._parse(data)
        self._held_bytes += len(data)
        for frame in frames:
            assert isinstance(frame, Frame)  # noqa: S101  # as the handshake is over
            self._held_bytes -= _least_size(len(frame.data))
            if frame.opcode in DATA:
                self._is_in_message = not frame.fin
        return frames


def _plain_messages(data: bytes, max_bytes: int | None) -> tuple[list[Event], int]:
    """Return the plain messages with which *data* begins, and where they end."""
    messages: list[Event] = []
    at = 0
    while at + _SHORT_HEAD <= len(data):
        opcode, length = _PLAIN.get(data[at]), data[at + 1]
        start = at + _SHORT_HEAD
        if _MASKED <= length < _MEDIUM:
            length -= _MASKED
        elif length == _MEDIUM:
            length = int.from_bytes(data[at + 2 : at + 4])
            start = at + _MEDIUM_HEAD
        else:
            break
        end = start + length
        if opcode is None or end > len(data) or (max_bytes is not None and length > max_bytes):
            break
        messages.append(
            Frame(opcode, apply_mask(data[start:end], data[start - _MASK_LENGTH : start]))
        )
        at = end
    return messages, at


def _least_size(length: int) -> int:
    """Return the fewest bytes that a client sends for a frame of a payload of *length* bytes."""
    if length < 126:
        return _SHORT_HEAD + length
    if length < 1 << 16:
        return _MEDIUM_HEAD + length
    return _LONG_HEAD + length
