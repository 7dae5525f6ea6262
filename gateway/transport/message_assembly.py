# SPDX-License-Identifier: Apache-2.0
"""WebSocket messages out of their fragments (RFC 6455, section 5.4)."""

from websockets.frames import Frame, Opcode


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
