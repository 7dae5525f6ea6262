# SPDX-License-Identifier: Apache-2.0
"""The WebSocket frames that a client sends (RFC 6455, section 5.2).

`websockets` reads them, and is ready to go on at any byte, which costs 3 us a frame in a hot loop.
Nearly all are complete messages of one frame. Read here they take a third of that.
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

# in the first byte
_FIN: Final = 0x80
_OPCODE: Final = 0x0F
# ... of a message in one frame: FIN, no extension, and the opcode
_PLAIN: Final = {_FIN | opcode: opcode for opcode in (Opcode.TEXT, Opcode.BINARY)}

# The second byte has a flag for the mask, which ends the head, and a length up to 125. The value
# 126 means that the length is in the next two bytes, and 127 that it is in the next eight.
_MASKED: Final = 0x80
_MEDIUM: Final = 126

_MASK_LENGTH: Final = 4
_SHORT_HEAD: Final = 2 + _MASK_LENGTH
_MEDIUM_HEAD: Final = 4 + _MASK_LENGTH
_LONGEST_HEAD: Final = 10 + _MASK_LENGTH


class FrameReader:
    """Reads plain messages of one client, and leaves everything else to `websockets`.

    It also reads the heads of the other frames, to know when `websockets` is between two messages.
    *protocol* has no extensions, and no limit for a single frame.
    """

    __slots__ = ("_head", "_is_in_message", "_missing_bytes", "_protocol")

    def __init__(self, protocol: ServerProtocol) -> None:
        self._protocol = protocol
        self._head = b""  # the first bytes of it, while they do not say how long the frame is
        self._missing_bytes = 0  # of the frame that `websockets` has begun
        self._is_in_message = False  # of which more frames have to come

    def read(self, data: bytes) -> Sequence[Event]:
        """Take the next bytes. Return the requests and frames that they complete."""
        data, self._head = self._head + data, b""
        events: list[Event] = []
        at = 0
        while at < len(data):
            if self._protocol.state is not OPEN:
                events += self._parse(data[at:])
                break
            if self._missing_bytes:
                part = data[at : at + self._missing_bytes]
                self._missing_bytes -= len(part)
                at += len(part)
                events += self._parse(part)
            elif not self._is_in_message and (end := self._read_plain(data, at, events)) > at:
                at = end
            elif not self._begin(data, at):
                self._head = data[at:]
                break
        return events

    def _read_plain(self, data: bytes, at: int, messages: list[Event]) -> int:
        """Append the plain messages from a place on to *messages*. Return where they end."""
        max_bytes = self._protocol.max_message_size
        while at + _SHORT_HEAD <= len(data):
            opcode, length = _PLAIN.get(data[at]), data[at + 1]
            start = at + _SHORT_HEAD
            if _MASKED <= length < _MASKED | _MEDIUM:
                length -= _MASKED
            elif length == _MASKED | _MEDIUM:
                length = int.from_bytes(data[at + 2 : at + 4], "big")
                start = at + _MEDIUM_HEAD
            else:
                break
            end = start + length
            if opcode is None or end > len(data) or (max_bytes is not None and length > max_bytes):
                break
            payload = apply_mask(data[start:end], data[start - _MASK_LENGTH : start])
            messages.append(Frame(opcode, payload))
            at = end
        return at

    def _begin(self, data: bytes, at: int) -> bool:
        """Look at the frame that begins there. Return whether its head is complete."""
        self._missing_bytes = _size(data[at : at + _LONGEST_HEAD])
        if not self._missing_bytes:
            return False
        if data[at] & _OPCODE in DATA:
            self._is_in_message = not data[at] & _FIN
        return True

    def _parse(self, data: bytes) -> list[Event]:
        self._protocol.receive_data(data)
        return self._protocol.events_received()


def _size(head: bytes) -> int:
    """Return how many bytes a frame has, or 0 if its head is not complete."""
    if len(head) < 2:
        return 0
    start, length = 2, head[1] & ~_MASKED
    if length >= _MEDIUM:
        start = 4 if length == _MEDIUM else 10
        length = int.from_bytes(head[2:start], "big")
    if len(head) < start:
        return 0
    return start + (_MASK_LENGTH if head[1] & _MASKED else 0) + length


class MessageAssembly:
    """Joins the frames of a message.

    `websockets` has checked the order of fragments, and bounds their total size.
    """

    __slots__ = ("_begins_text", "_fragments", "is_text")

    def __init__(self) -> None:
        self._fragments: list[bytes] = []
        self.is_text = False  # the message that was added last
        self._begins_text = False  # the one of which more frames have to come

    def add(self, frame: Frame) -> bytes | None:
        """Take a data frame. Return the message that it completes."""
        data = bytes(frame.data)
        if frame.opcode is not Opcode.CONT:
            self.is_text = frame.opcode is Opcode.TEXT
            if frame.fin:  # maybe ahead of its turn, within a message of several frames
                return data
            self._begins_text = self.is_text
        if data:  # otherwise any number of them would be kept
            self._fragments.append(data)
        if not frame.fin:
            return None
        message, self._fragments = b"".join(self._fragments), []
        self.is_text = self._begins_text
        return message
