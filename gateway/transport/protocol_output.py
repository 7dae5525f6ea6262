# SPDX-License-Identifier: Apache-2.0
"""The bytes that `websockets` sends by itself: the handshake, pongs, the close frame."""

import asyncio
import contextlib
from collections.abc import Sequence
from typing import Final

from gateway.transport.pacing import Pacing

MAX_PROTOCOL_BACKLOG_BYTES: Final = 64 * 1024  # pongs for a peer that pings and never reads


class ProtocolOutput:
    """Writes it to the transport, past the outbox."""

    def __init__(self, transport: asyncio.Transport, pacing: Pacing) -> None:
        self._transport = transport
        self._pacing = pacing
        self.is_encrypted = transport.get_extra_info("sslcontext") is not None
        self._backlog_bytes = 0

    def taken(self) -> None:
        """Note that the socket has taken what was written so far."""
        self._backlog_bytes = 0

    def write(self, output: Sequence[bytes], *, may_be_large: bool) -> bool:
        """Write *output*. Return whether too much of it waits for a peer that does not read.

        An empty item is the end of all output.
        """
        if not output or self._transport.is_closing():
            return False
        before = self._transport.get_write_buffer_size()
        for data in output:
            if data:
                self._transport.write(data)
            elif self.is_encrypted:  # TLS has no half that could be closed alone
                self._transport.close()
            else:
                with contextlib.suppress(OSError):  # the peer closed first
                    self._transport.write_eof()
        if may_be_large:  # a page, which is not a flood
            return False
        grown = self._transport.get_write_buffer_size() - before
        is_paused = self._pacing.is_paused  # perhaps by what was written just now
        self._backlog_bytes = self._backlog_bytes + grown if is_paused else 0
        return self._backlog_bytes > MAX_PROTOCOL_BACKLOG_BYTES
