# SPDX-License-Identifier: Apache-2.0
"""One client's socket: bytes in and out, flow control, keep-alive, orderly closing.

The WebSocket protocol itself is `websockets`' sans-I/O `ServerProtocol`. Most input goes
through the `FrameReader` instead. Outgoing data frames are built once for all clients, and written
here in batches, as far as the socket accepts them. The rest waits, and can be dropped.
"""

import asyncio
import logging
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Final, cast

from websockets.exceptions import InvalidMessage, PayloadTooBig
from websockets.frames import Frame, Opcode
from websockets.http11 import Request, Response
from websockets.protocol import CONNECTING, OPEN, Event

from gateway.access.permissions import Identity
from gateway.core.entries import Entry
from gateway.core.errors import ProtocolError
from gateway.core.peer import Authenticate, Peer
from gateway.core.token_bucket import TokenBucket
from gateway.transport.batches import batch_writer
from gateway.transport.close_codes import (
    INTERNAL_ERROR,
    MESSAGE_TOO_BIG,
    POLICY_VIOLATION,
)
from gateway.transport.end import (
    LOOKED_AWAY,
    ConnectionEnd,
    EndCause,
    answered,
    closed_by_gateway,
    ended_elsewhere,
)
from gateway.transport.frame_reader import DATA, MessageAssembly
from gateway.transport.front import ClientSession, Front
from gateway.transport.http import new_protocol
from gateway.transport.inbound import READ_CHUNK_BYTES, Inbound
from gateway.transport.inbound_text import expect_text, receive_message
from gateway.transport.keep_alive import Close, KeepAlive, SendPing
from gateway.transport.pacing import Pacing
from gateway.transport.protocol_output import ProtocolOutput
from gateway.transport.tcp_info import tune
from gateway.transport.url_options import UrlOptions
from gateway.transport.writing import WritingConnection

if TYPE_CHECKING:  # it imports this
    from gateway.transport.robot_paths import RobotPaths
    from gateway.transport.server import Server

logger = logging.getLogger(__name__)

WRITE_HIGH_WATER_BYTES: Final = 64 * 1024  # beyond this, frames wait where they can be dropped


class Connection(WritingConnection):
    """A client from TCP accept to the end. Everything runs on the event loop's thread."""

    def __init__(self, server: "Server | RobotPaths") -> None:
        connections = server.connections
        limits = connections.limits
        super().__init__(
            new_protocol(limits.max_message_bytes, self._choose), next(connections.numbers)
        )
        self.server = server  # until the request, it may be the paths of several
        self._connections = connections
        self._limits = limits
        self._buffer = bytearray(READ_CHUNK_BYTES)
        self._inbound: Inbound
        self._robot: Server
        self._front: Front
        self._assembly = MessageAssembly()
        self._flushing = False
        now_ns = time.monotonic_ns()
        self._frames = TokenBucket(self._limits.frames_per_s, self._limits.frame_burst, now_ns)
        self._opened_s = now_ns / 1e9
        self.keep_alive = KeepAlive(self._limits, self._opened_s)
        self._start = b""  # of the HTTP request
        self._bytes_in = 0

    # Called by asyncio

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Take over an accepted socket."""
        self._transport = transport = cast("asyncio.Transport", transport)
        self._write_batch = batch_writer(transport)
        transport.set_write_buffer_limits(high=WRITE_HIGH_WATER_BYTES)
        peer = transport.get_extra_info("peername")
        self.address = str(peer[0]) if peer else "?"
        tune(transport.get_extra_info("socket"))
        self.spending = self._connections.budgets.open(self.address)
        self._inbound = Inbound(self, self._protocol, transport, self.spending)
        self._pacing = Pacing(transport, self._go_on, self._note_rate)
        self._output = ProtocolOutput(transport, self._pacing)
        self.is_encrypted = self._output.is_encrypted
        self._connections.add(self)

    def get_buffer(self, sizehint: int) -> bytearray:
        """Lend the buffer, which bounds one read."""
        del sizehint
        return self._buffer

    def buffer_updated(self, nbytes: int) -> None:
        """Process the bytes read."""
        now_s = time.monotonic()
        self._bytes_in += nbytes
        self._start = self._start or bytes(self._buffer[: min(nbytes, 16)])
        self._inbound.receive(bytes(memoryview(self._buffer)[:nbytes]), now_s)

    def eof_received(self) -> bool:
        """Record that the peer has closed its side. Return whether something is left to do."""
        if self._closing_s is None and self._inbound.end():
            return True
        self._protocol.receive_eof()
        self._write_protocol_output()
        return False

    def connection_lost(self, exc: Exception | None) -> None:
        """Release everything of this client."""
        start_s = time.monotonic()
        self._pacing.socket_full()  # it accepts nothing more
        self._inbound.close()
        self._protocol.receive_eof()
        session, self._session = self._session, None
        try:
            self.server.left(self, session, self._end(session, exc, start_s))
        finally:  # the time to close its subscriptions also counts for the client
            self.spending.close(time.monotonic() - start_s)
            self._pacing.close()

    def pause_writing(self) -> None:
        """Stop sending from the outbox: the socket is full."""
        self._pacing.socket_full()

    def resume_writing(self) -> None:
        """Continue: the socket has sent most of its bytes."""
        self._output.taken()
        self._pacing.socket_ready()

    # Called by the server

    def flush(self) -> None:
        """Send from the outbox, as far as the socket accepts it."""
        if self._flushing or self.is_paused or self._session is None:
            return
        self._flushing = True  # encoding may report an error, which wakes us again
        outbox, pacing = self._session.outbox, self._pacing
        try:
            while outbox.size and not pacing.is_paused and self._protocol.state is OPEN:
                batch = outbox.take(max(1, min(pacing.room_bytes, WRITE_HIGH_WATER_BYTES)))
                if not batch and not outbox.has_control:  # encoding may have added a status
                    break
                self._write_batch(batch)
                pacing.wrote(sum(map(len, batch)))
        except Exception as bug:  # noqa: BLE001  # of one client's
            self.fail(bug)
        finally:
            self._flushing = False

    def peer(
        self, identity: Identity | None, options: UrlOptions, authenticate: Authenticate
    ) -> Peer:
        """Return what the session of this client is to know of it."""
        return Peer(
            wake=self.flush,
            name=self.name,
            address=self.address,
            identity=identity,
            image_format=options.images,
            level=options.status,
            turns=self._inbound,
            authenticate=authenticate,
            on_unreadable=expect_text(self._assembly, self.close),
        )

    def tick(self, now_s: float) -> None:
        """End a client after its timeouts, and send pings. Called every `TICK_S` of the server."""
        self._inbound.tick(now_s)
        limits = self._limits
        if self._closing_s is not None:
            if now_s - self._closing_s > limits.close_timeout_s:
                self.abort()
        elif self._protocol.close_expected():  # messages often come in one packet with a close
            if not self._inbound and not self._is_sending_page(now_s):
                self._closing_s = now_s
        elif self._viewer is not None:
            self._viewer.tick(now_s)
            self._check(now_s, self._viewer)
        elif self._protocol.state is CONNECTING:
            if now_s - self._opened_s > limits.open_timeout_s:
                self._give_up(f"within {limits.open_timeout_s:g} s")
        elif self._protocol.state is OPEN and self._session is not None:
            self._check(now_s, self._session)

    def _give_up(self, in_time: str) -> None:
        """End a connection that has neither become a client nor got its page in time."""
        if self._gets_page:
            self.answer(self._protocol.reject(503, f"busy: no page {in_time}\n"))
        else:
            self.abort(EndCause("gateway", "handshake", f"no handshake {in_time}"))

    def _is_sending_page(self, now_s: float) -> bool:
        """Return whether a peer without a session must still accept its answer."""
        end_s = self._opened_s + self._limits.open_timeout_s + self._limits.send_deadline_s
        is_sending = self._session is None and self._transport.get_write_buffer_size() > 0
        return is_sending and now_s <= end_s

    # Called by its `Inbound`

    def handle(self, event: Event | Callable[[], None]) -> None:
        """Handle one request or frame, or go on with the work of an earlier one."""
        if isinstance(event, Request):
            self._open(event)
        elif self._session is None or self._closing_s is not None or isinstance(event, Response):
            pass  # there is no session any more, or not yet
        elif not isinstance(event, Frame):
            event()
        elif not self._frames.allow(time.monotonic_ns()):
            most = f"at most {self._limits.frames_per_s:g} frames per second"
            self.close(POLICY_VIOLATION, f"{most} (limits.frames_per_s)")
        elif event.opcode is Opcode.PONG:
            self.keep_alive.ponged(time.monotonic())
        elif event.opcode in DATA:  # `websockets` answers pings and records closes
            message = self._assembly.add(event)
            if message is not None:
                # The state may be closing already: a close often comes with the last message.
                receive = self._front.receive
                receive_message(self._session, message, receive, is_text=self._assembly.is_text)

    def end_piece(self) -> None:
        """Send the answers of `websockets`. Before its own close frame, send the reason."""
        if output := self._protocol.data_to_send():
            try:
                self._explain_failure()
            finally:  # to encode what waits may fail
                self._write_output(output)

    def end_turn(self) -> None:
        """Carry out deferred work."""
        if self._session is not None and self._session.deferred:
            self._robot.end_turn(self._session)

    def fail(self, bug: Exception) -> None:
        """Close this client because of a fault of the gateway, which affects no other client."""
        logger.error("connection failed", exc_info=bug, extra={"client": self.name})
        self.close(INTERNAL_ERROR, "internal error")

    # Incoming

    def _choose(self, offered: Sequence[str]) -> str | None:
        return self.server.choose(offered)

    def _open(self, request: Request) -> None:
        server = self.server = self.server.of(request)
        response = server.respond(self, self._protocol, request)
        self._gets_page = response is None and self._viewer is None
        if response is not None:
            self.answer(response)
        if self._protocol.state is not OPEN:
            # until a request is answered, `websockets` would parse the input behind it as frames
            self._inbound.ignore()
            return
        server = self._robot = cast("Server", server)  # no other begins a WebSocket
        self.address = server.client_address(self.address, request)
        self.spending.move(self.address)
        self._front = server.fronts.of(self._protocol.subprotocol)
        self._session = server.enter(self, self._front, request)
        if self._session is None:
            self._inbound.drop()
            return
        self._session.outbox.connect(self._write_directly, self._pacing)
        logger.info("connected", extra={"client": self.name})

    def _explain_failure(self) -> None:
        """Send the reason of a close by `websockets` in a `status`, if the client can get one."""
        if self._closing_s is not None:
            return
        if self._session is None:
            if isinstance(self._protocol.handshake_exc, InvalidMessage):
                self._closing_s = time.monotonic()
                response = self.server.malformed(self._start)
                self._cause = answered(int(response.split()[1]), "not a supported HTTP request")
                self._transport.write(response)
            return
        if isinstance(self._protocol.parser_exc, PayloadTooBig):
            self._closing_s = time.monotonic()
            most = f"{self._protocol.max_message_size} bytes (limits.max_message_bytes)"
            text = f"message too large: send at most {most}"
            self._cause = closed_by_gateway(MESSAGE_TOO_BIG, text)
            self._session.refuse(ProtocolError("limit_exceeded", text))
            # the state is no longer open, so `flush` would not send it
            self._write_batch(self._session.outbox.take(WRITE_HIGH_WATER_BYTES))

    # Outgoing

    def _write_directly(self, entry: Entry) -> int:
        """Send an entry that need not wait. See `gateway.core.entries.WriteDirectly`."""
        if self._flushing or self._pacing.is_paused:
            return 0
        try:
            frame = entry.frame()
            if not isinstance(frame, bytes):  # not ready, or in pieces, which are written together
                return 0
            self._transport.write(frame)
        except Exception as bug:  # noqa: BLE001  # of one client's
            self.fail(bug)
            return 0
        self._pacing.wrote(len(frame))
        return len(frame)

    def _go_on(self) -> None:
        self.flush()
        if self._viewer is not None:
            self._viewer.flush()

    def _note_rate(self, bytes_per_s: float | None) -> None:
        session = self._viewer or self._session
        if session is not None:
            session.outbox.drains(bytes_per_s)

    # Time

    def _end(
        self, session: ClientSession | None, error: Exception | None, now_s: float
    ) -> ConnectionEnd:
        cause = self._cause or (LOOKED_AWAY if self._viewer and error is None else None)
        cause = cause or ended_elsewhere(
            self._protocol, error, was_open=session is not None, is_silent=not self._bytes_in
        )
        end = ConnectionEnd(self.name, cause, now_s - self._opened_s, self._bytes_in)
        if session is None:
            return end
        return replace(end, messages_in=session.received, frames_out=session.outbox.sent)

    def _check(self, now_s: float, session: ClientSession) -> None:
        match self.keep_alive.check(now_s, session.outbox, self._pacing):
            case SendPing() if self._viewer is None:
                self._protocol.send_ping(b"")
                self._write_protocol_output()
            case Close(code, reason):
                self.close(code, reason)
            case EndCause() as cause:
                self.abort(cause)
