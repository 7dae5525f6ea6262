# SPDX-License-Identifier: Apache-2.0
"""WebSocket frames, parsed as cheaply as Python can: for benchmarks only.

A library takes about 30 us for a message, more than the measured cost. This walks the frames of a
correct server in place. It omits the library's checks and joins no fragments: each is a separate
payload.
"""

import struct
from collections.abc import Iterator
from typing import Final, NamedTuple

TEXT: Final = 0x1
BINARY: Final = 0x2
CLOSE: Final = 0x8
PING: Final = 0x9
PONG: Final = 0xA

_FINAL: Final = 0x80
_MASKED: Final = 0x80
_OPCODE: Final = 0x0F
_TWO_BYTES: Final = 126  # RFC 6455, section 5.2: the length is in the next two bytes
_EIGHT_BYTES: Final = 127
_NO_MASK: Final = bytes(4)  # a client must mask. This key leaves every byte as it is


class Frame(NamedTuple):
    """One frame. Its payload is valid until the next bytes are received."""

    opcode: int
    payload: memoryview


class FrameWalker:
    """Finds the frames of a server in the bytes of a connection, in its own buffer."""

    def __init__(self, room: int = 1 << 20) -> None:
        self._buffer = bytearray(room)
        self._start = 0  # of the bytes not walked yet
        self._end = 0  # of the bytes received

    def room(self) -> memoryview:
        """Return the room for the next bytes, at least a quarter of all."""
        if self._start:
            waiting = self._end - self._start
            self._buffer[:waiting] = self._buffer[self._start : self._end]
            self._start, self._end = 0, waiting
        if len(self._buffer) - self._end < len(self._buffer) // 4:
            # a new one, as a buffer whose payload is still in use cannot grow
            self._buffer = self._buffer + bytearray(len(self._buffer))
        return memoryview(self._buffer)[self._end :]

    def received(self, size: int) -> Iterator[Frame]:
        """Take *size* more bytes in that room, and yield every complete frame."""
        self._end += size
        view = memoryview(self._buffer)
        while True:
            header = _header(self._buffer, self._start, self._end)
            if header is None:
                return
            begin, length = header
            if begin + length > self._end:
                return
            opcode = self._buffer[self._start] & _OPCODE
            self._start = begin + length
            yield Frame(opcode, view[begin : self._start])


def client_frame(opcode: int, payload: bytes) -> bytes:
    """Return a client's frame."""
    first = _FINAL | opcode
    length = len(payload)
    if length < _TWO_BYTES:
        head = struct.pack(">BB", first, _MASKED | length)
    elif length < 1 << 16:
        head = struct.pack(">BBH", first, _MASKED | _TWO_BYTES, length)
    else:
        head = struct.pack(">BBQ", first, _MASKED | _EIGHT_BYTES, length)
    return head + _NO_MASK + payload


def _header(buffer: bytearray, start: int, end: int) -> tuple[int, int] | None:
    """Return the start and the length of the payload of the frame at *start*."""
    if end - start < 2:
        return None
    length = buffer[start + 1]
    if length < _TWO_BYTES:
        return start + 2, length
    size = 2 if length == _TWO_BYTES else 8
    begin = start + 2 + size
    return (begin, int.from_bytes(buffer[start + 2 : begin], "big")) if begin <= end else None
