# SPDX-License-Identifier: Apache-2.0
"""The answers of one connection that bypass the outbox, and its end by the gateway.

These are responses to HTTP requests, and what `websockets` sends by itself.
"""

import asyncio
import time
from collections.abc import Sequence
from dataclasses import replace

from websockets.http11 import Response
from websockets.protocol import CONNECTING, OPEN
from websockets.server import ServerProtocol

from gateway.transport.end import EndCause, answered_with, closed_by_gateway
from gateway.transport.front import ClientSession, HttpSession
from gateway.transport.pacing import Pacing
from gateway.transport.protocol_output import ProtocolOutput


class WritingConnection(asyncio.BufferedProtocol):
    """The part of a connection that answers and ends it. `Connection` reads, and is the whole."""

    def __init__(self, protocol: ServerProtocol, number: int) -> None:
        self._protocol = protocol
        self._number = number
        self._transport: asyncio.Transport
        self._pacing: Pacing
        self._output: ProtocolOutput
        self._session: ClientSession | None = None
        self._viewer: HttpSession | None = None  # of pictures, by plain HTTP
        self._gets_page = False  # of those that are written later
        self._closing_s: float | None = None
        self._cause: EndCause | None = None  # it ends
        self.address = "?"

    @property
    def session(self) -> ClientSession | None:
        """The session, while the WebSocket is open."""
        return self._session

    @property
    def name(self) -> str:
        """The address and number of the client, for the log."""
        return f"{self.address}#{self._number}"

    @property
    def is_paused(self) -> bool:
        """True while the socket or the link is full."""
        return self._pacing.is_paused

    @property
    def is_half_open(self) -> bool:
        """True until the peer has sent its request."""
        return self._protocol.state is CONNECTING and not (self._viewer or self.is_leaving)

    @property
    def is_leaving(self) -> bool:
        """True of a connection that is not a client, and will not become one."""
        is_closing = self._closing_s is not None or self._protocol.close_expected()
        return self._session is None and is_closing

    @property
    def awaits_page(self) -> bool:
        """True until it has accepted the page that it gets later."""
        has_taken = self._protocol.eof_sent and not self._transport.get_write_buffer_size()
        return self._gets_page and not has_taken

    def close(self, code: int, reason: str) -> None:
        """Begin the closing handshake. `tick` ends it by force if the peer does not answer."""
        if self._closing_s is None:
            self._closing_s = time.monotonic()
        if self._protocol.state is OPEN:
            self._cause = self._cause or closed_by_gateway(code, reason)
            self._protocol.send_close(code, reason)
            self._write_protocol_output()
        elif self._protocol.state is CONNECTING:
            self._cause = self._cause or replace(closed_by_gateway(code, reason), code=None)
            self._transport.close()

    def reject(self, close_code: int, reason: str, text: bytes | None) -> None:
        """Close a client without a session. If there is a *text*, send that first."""
        # .NET's WebSocket shows its program no close code of 1012 to 1014, and no reason
        if text is not None:
            self._protocol.send_text(text)
        self.close(close_code, reason)

    def answer(self, response: Response) -> None:
        """Send the response to the HTTP request, unless the peer is gone."""
        if self._transport.is_closing() or self._protocol.eof_sent:
            return
        self._cause = answered_with(response)
        self._protocol.send_response(response)
        self._write_protocol_output(may_be_large=True)

    def show(self, viewer: HttpSession) -> None:
        """Let a viewer answer the HTTP request, now or part by part."""
        self._viewer = viewer

    def write(self, data: bytes) -> None:
        """Send a part of the response to the HTTP request, unless the peer is gone."""
        if not self._transport.is_closing():
            self._transport.write(data)
            self._pacing.wrote(len(data))

    def limit_messages(self, max_bytes: int) -> None:
        """Accept messages of at most so many bytes from now on."""
        self._protocol.max_message_size = max_bytes

    def abort(self, cause: EndCause | None = None) -> None:
        """Cut the connection. Give a cause unless it is ending already."""
        self._cause = self._cause or cause
        self._closing_s = self._closing_s or time.monotonic()
        self._transport.abort()

    def _write_protocol_output(self, *, may_be_large: bool = False) -> None:
        self._write_output(self._protocol.data_to_send(), may_be_large=may_be_large)

    def _write_output(self, output: Sequence[bytes], *, may_be_large: bool = False) -> None:
        if self._session is not None and self._protocol.state is not OPEN:
            self._session.outbox.disconnect()  # a close frame must be the last one
        if self._output.write(output, may_be_large=may_be_large):
            self.abort(EndCause("gateway", "abuse", "it sends pings and reads nothing"))
