# SPDX-License-Identifier: Apache-2.0
"""The input of one client that is not handled yet, and the pace at which it is.

Everything is handled in the order in which it came, a slice at a time. While anything waits here
the socket is not read, so that it is one read at most, and TCP holds the sender back.
"""

import asyncio
import time
from collections import deque
from collections.abc import Callable
from typing import Final, Protocol

from websockets.protocol import Event
from websockets.server import ServerProtocol

from gateway.server.frame_reader import FrameReader
from gateway.server.time_budget import Spending

READ_CHUNK_BYTES: Final = 16 * 1024  # one greedy sender cannot occupy the loop for long
# A control frame takes 4 us in a hot loop, and the smallest has 6 bytes: 2.7 ms for 4 KiB.
PIECE_BYTES: Final = 4 * 1024
SLICE_S: Final = 0.004  # then the others have their turn: a tenth of what people notice in a hand
# What a read costs before it comes here: the loop's poll, the call of the kernel, 16 KiB copied.
READ_COST_S: Final = 15e-6

# If nothing is read in so many turns of the loop, neither the kernel nor TLS holds more: a reader
# may run behind us in a turn, and TLS takes one to go on and one to read.
EMPTY_TURNS: Final = 4

_END_OF_HEAD: Final = b"\r\n\r\n"


class Receiver(Protocol):
    """The connection that handles what comes in."""

    def handle(self, event: Event | Callable[[], None]) -> None:
        """Handle one request or frame, or do what one that was handled has left to do."""

    def end_piece(self) -> None:
        """Send what `websockets` answers by itself: all before it is handled."""

    def end_turn(self) -> None:
        """Note that others have their turn now."""

    def fall_behind(self, *, is_behind: bool) -> None:
        """Note that its budget is spent, or is no longer."""

    def fail(self, bug: Exception) -> None:
        """Close this client for a bug of ours."""


class Inbound:
    """The bytes of one read that are not parsed, and the events that are not handled."""

    def __init__(
        self,
        receiver: Receiver,
        protocol: ServerProtocol,
        transport: asyncio.Transport,
        spending: Spending,
    ) -> None:
        self._receiver = receiver
        self._reader = FrameReader(protocol)
        self._transport = transport
        self._spending = spending
        spending.go_on = self.go_on
        self._unparsed = b""
        self._events: deque[Event | Callable[[], None]] = deque()
        self._is_turn_over = False
        self._head: bytes | None = b""  # the end of the HTTP request so far; None: it is complete
        self._is_ignored = False  # what comes
        self.is_paused = False  # reading, until what waits is handled and paid for
        self._reads = 0
        self._read_s = 0.0  # the time of the last one
        self._late_since_s: float | None = None  # what comes may have waited since then
        self._is_behind = False
        self._next_slice: asyncio.Handle | None = None

    def __bool__(self) -> bool:
        """Return whether anything waits."""
        return bool(self._events or self._unparsed)

    def receive(self, data: bytes, now_s: float) -> None:
        """Take what was read, and handle it as far as a slice allows."""
        self._reads += 1
        self._read_s = now_s
        if not self._is_ignored:
            self._unparsed += data
        self._work(now_s, READ_COST_S)

    def go_on(self) -> None:
        """Handle what waits, a slice of it; then read again."""
        self._next_slice = None
        self._work(time.monotonic(), 0.0)

    def waited_s(self) -> float:
        """Return for how long what is being handled may have waited, here or in the kernel."""
        since_s = self._read_s if self._late_since_s is None else self._late_since_s
        return time.monotonic() - since_s

    def next_turn(self, work: Callable[[], None]) -> None:
        """Do *work* when the others have had their turn, and before anything else that waits."""
        self._events.appendleft(work)
        self._is_turn_over = True

    def drop(self) -> None:
        """Forget what waits: nobody wants it any more."""
        self._unparsed = b""
        self._events.clear()
        self._is_turn_over = False

    def ignore(self) -> None:
        """Forget what waits, and all that comes; reading it is paid for nevertheless."""
        self._is_ignored = True
        self.drop()

    def close(self) -> None:
        """Forget what waits, and never go on."""
        self.drop()
        if self._next_slice is not None:
            self._next_slice.cancel()
        self._spending.close()

    def _work(self, now_s: float, cost_s: float) -> None:
        # what is left of a large message does not wait for the budget, but what is behind it does
        is_due_alone = self._is_turn_over and self._is_behind
        try:
            self._handle_until(0.0 if is_due_alone else now_s + SLICE_S)
            self._receiver.end_turn()
        except Exception as error:  # noqa: BLE001  # a bug of ours: the others are unharmed
            self.drop()
            self._receiver.fail(error)
        end_s = time.monotonic()
        may_go_on = self._spending.spend(end_s - now_s + cost_s, end_s)
        if may_go_on is self._is_behind:
            self._is_behind = not may_go_on
            self._receiver.fall_behind(is_behind=self._is_behind)
        if self._is_turn_over:  # it pays afterwards: a large message takes memory while it waits
            self._go_on_soon()
        elif self._head is None and not may_go_on:
            self._pause()
            self._spending.wait()
        elif self:
            self._go_on_soon()
        elif self._late_since_s is not None and not self._transport.is_closing():
            if self.is_paused:
                self.is_paused = False
                self._transport.resume_reading()
            self._catch_up(self._reads, EMPTY_TURNS)

    def _go_on_soon(self) -> None:
        self._pause()
        self._next_slice = asyncio.get_running_loop().call_soon(self.go_on)

    def _pause(self) -> None:
        if not self.is_paused and not self._transport.is_closing():
            self.is_paused = True
            self._transport.pause_reading()
            if self._late_since_s is None:
                self._late_since_s = self._read_s

    def _catch_up(self, reads: int, turns: int) -> None:
        """Note that nothing is late any more, if nothing is read for some turns of the loop."""
        if self.is_paused or reads != self._reads:
            return  # whoever reads begins anew
        if turns:
            asyncio.get_running_loop().call_soon(self._catch_up, reads, turns - 1)
        else:
            self._late_since_s = None

    def _handle_until(self, end_s: float) -> None:
        """Handle what waits until there is nothing or it is *end_s*, but at least one event."""
        self._is_turn_over = False
        while self._events or self._unparsed:
            if not self._events:
                self._events.extend(self._reader.read(self._cut()))
            while self._events:
                self._receiver.handle(self._events.popleft())
                if self._events and (self._is_turn_over or time.monotonic() > end_s):
                    return
            self._receiver.end_piece()
            if self._unparsed and time.monotonic() > end_s:
                return

    def _cut(self) -> bytes:
        """Take the next piece of what is not parsed; the first one ends with the HTTP request.

        `websockets` would parse frames behind a request that is not answered yet.
        """
        size = PIECE_BYTES
        if self._head is not None:
            head = self._head + self._unparsed
            end = head.find(_END_OF_HEAD)
            size = len(self._unparsed) if end < 0 else end + len(_END_OF_HEAD) - len(self._head)
            self._head = head[1 - len(_END_OF_HEAD) :] if end < 0 else None
        piece, self._unparsed = self._unparsed[:size], self._unparsed[size:]
        return piece
