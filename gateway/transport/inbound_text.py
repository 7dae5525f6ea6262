# SPDX-License-Identifier: Apache-2.0
"""Text frames, which must be UTF-8 (RFC 6455, section 8.1)."""

from collections.abc import Callable

from gateway.codec.cbor_reader import is_cbor
from gateway.codec.json import invalid_at
from gateway.core.errors import ProtocolError
from gateway.transport.close_codes import INVALID_DATA
from gateway.transport.frame_reader import MessageAssembly
from gateway.transport.front import ClientSession


def receive_message(
    session: ClientSession,
    message: bytes,
    receive: Callable[[ClientSession, bytes], None],
    *,
    is_text: bool,
) -> None:
    """Have a message carried out."""
    if is_text and is_cbor(message):  # UTF-8 cannot begin like that
        text = f"{_not_utf8(message)}. Send CBOR in binary frames"
        session.refuse(ProtocolError("bad_json", text))
        session.peer.on_unreadable(message)
    else:
        receive(session, message)


def expect_text(
    assembly: MessageAssembly, close: Callable[[int, str], None]
) -> Callable[[bytes], None]:
    """Return a check that closes, as an endpoint must, if text is not UTF-8.

    Text that was read as JSON is valid. A check before that takes two thirds of the reading time.
    """

    def look(message: bytes) -> None:
        if assembly.is_text and (text := _not_utf8(message)):
            close(INVALID_DATA, text)

    return look


def _not_utf8(message: bytes) -> str:
    offset = invalid_at(message)
    return "" if offset is None else f"not UTF-8: byte 0x{message[offset]:02x} at offset {offset}"
