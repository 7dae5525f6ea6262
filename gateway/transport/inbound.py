# SPDX-License-Identifier: Apache-2.0
"""The input of one client that waits, and the pace of its handling.

Everything is handled in the order of arrival, except a `stop`, which goes first.
While input waits, the socket is not read, so at most one read waits, and TCP slows the sender down.
A client that has spent its time is read ahead, because its input may contain a `stop`.
"""

import asyncio
import sys
import time
from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING, Final, TypeGuard

from websockets.frames import Frame, Opcode
from websockets.protocol import OPEN, Event
from websockets.server import ServerProtocol

from gateway.core.peer import ClientTurns
from gateway.transport.frame_reader import FrameReader
from gateway.transport.tcp_info import is_ended
from gateway.transport.time_budget import Spending

if TYPE_CHECKING:  # it imports this
    from gateway.transport.connection import Connection

READ_CHUNK_BYTES: Final = 16 * 1024  # one greedy sender cannot occupy the loop for long
# A control frame takes 4 us in a hot loop, and the smallest has 6 bytes: 2.7 ms for 4 KiB.
CHUNK_BYTES: Final = 4 * 1024
# The cost of a read before it comes here: the loop's poll, the system call, a copy of 16 KiB.
READ_COST_S: Final = 15e-6

# If no read fills its buffer in so many turns of the loop, neither the kernel nor TLS holds more. A
# reader may run after us in a turn, and TLS needs one turn to resume and one to read.
EMPTY_TURNS: Final = 4

# Input that is read ahead of a client without time left: 10 s of subscriptions, at most 2 MB.
MAX_AHEAD: Final = 4096
MAX_AHEAD_BYTES: Final = 256 * 1024
MAX_STOP_BYTES: Final = 1024  # of a message that may be a `stop`: two names, and room

# The publishes of a client that has left are carried out for so long, if its time allows.
LEFTOVER_S: Final = 1.0
# ... and when its socket is gone: 500 small ones, and its robot stops behind them.
LAST_S: Final = 0.02
# Operations that are carried out after a client has left: they affect others.
_LASTING: Final = (b"publish", b"advertise", b"fragment")

_END_OF_HEAD: Final = b"\r\n\r\n"


class Inbound(ClientTurns):
    """The bytes of one read that are not parsed, and the events that are not handled."""

    def __init__(
        self,
        connection: "Connection",
        protocol: ServerProtocol,
        transport: asyncio.Transport,
        spending: Spending,
    ) -> None:
        self._connection = connection
        self._protocol = protocol
        self._reader = FrameReader(protocol)
        self._transport = transport
        self._spending = spending
        self._unparsed = b""
        self._events: deque[Event | Callable[[], None]] = deque()
        self._ahead_bytes = 0  # of the input that was parsed since nothing waited
        self._overtaken = 0  # of the events those before a `stop` that was carried out
        self._is_turn_over = False
        self._head: bytes | None = (
            b""  # the end of the HTTP request so far, or None if it is complete
        )
        self._is_ignored = False  # further input
        self._is_closed = False
        self._is_at_end = False  # the client sends nothing more
        self._left_s: float | None = None  # when it was seen that the client has left
        self.is_paused = False  # reading, until what waits is handled, or there is room
        self._read_s = 0.0  # the time of the oldest one that is not handled
        self._cost_s = 0.0  # of reading, since it was paid for
        self._late_since_s: float | None = None  # the next input may have waited since then
        self._is_catching_up = False
        self.is_behind = False  # its budget is spent
        self._is_waiting = False  # for its budget

    def __bool__(self) -> bool:
        """Return whether anything waits."""
        return bool(self._events or self._unparsed)

    def receive(self, data: bytes, now_s: float) -> None:
        """Add input, which is handled as soon as all sockets are read."""
        if not self:
            self._read_s = now_s
        self._cost_s += READ_COST_S
        if not self._is_ignored:
            self._unparsed += data
        if len(self._unparsed) >= READ_CHUNK_BYTES:
            self._pause()
        self._spending.turns.add(self)

    def go_on(self) -> None:
        """Handle a slice of the waiting input: the budget allows it."""
        self._is_waiting = False
        self._spending.turns.add(self)

    def waited_s(self) -> float:
        """Return how long the current input may have waited, here or in the kernel."""
        since_s = self._read_s if self._late_since_s is None else self._late_since_s
        return time.monotonic() - since_s

    def spend(self, spent_s: float, now_s: float) -> bool:
        """Pay for work that a task does for this client. Return whether time is left."""
        return self._spending.spend(spent_s, now_s)

    def next_turn(self, work: Callable[[], None]) -> None:
        """Do *work* when the others have had their turn, and before anything else that waits."""
        self._events.appendleft(work)
        self._overtaken += self._overtaken > 0
        self._is_turn_over = True

    def drop(self) -> None:
        """Forget the waiting input."""
        self._unparsed = b""
        self._events.clear()
        self._is_turn_over = False

    def ignore(self) -> None:
        """Forget the waiting and all further input. Reading it still costs the client time."""
        self._is_ignored = True
        self.drop()

    def end(self) -> bool:
        """Take note that the client sends nothing more. Return whether something waits still.

        Then the transport is closed once that is carried out, unless TLS is closed by itself.
        """
        if self.is_behind:
            self._leave()
        self._is_at_end = bool(self) and self._transport.get_extra_info("sslcontext") is None
        return self._is_at_end

    def tick(self, now_s: float) -> None:
        """End a client that has spent its time and has left."""
        if self._left_s is not None:
            if now_s - self._left_s > LEFTOVER_S:
                self._transport.abort()
        elif self.is_behind and is_ended(self._transport.get_extra_info("socket")):
            self._leave()
            self._spending.turns.add(self)

    def close(self) -> None:
        """Carry out the last of a client whose socket is gone, and never go on."""
        if self.is_behind:
            self._leave()
        end_s = time.monotonic() + LAST_S
        try:
            while self and time.monotonic() < end_s:
                self._handle_until(end_s)
            self._connection.end_turn()
        except Exception as error:  # noqa: BLE001  # a bug of ours: the others are unharmed
            self._connection.fail(error)
        self.drop()
        self._is_closed = True

    # Called by `Turns`

    def rank(self, now_s: float) -> int:
        """Return 0 of a client that drives, 1 of one that has spent little, 2 of the others."""
        if self._drives():
            return 0
        return 1 if self._spending.own.is_half_full(now_s) else 2

    def work(self, end_s: float) -> None:
        """Carry out each `stop`, then what came before it, until a time."""
        if self._is_closed:
            return
        start_s = time.monotonic()
        try:
            self._look_ahead(end_s)
            if self._is_waiting and self._may_drive():
                self._spending.stop_waiting()
                self._is_waiting = False
            if not self._is_waiting:
                # the rest of a large message does not wait, but the input behind it does
                is_due_alone = self._is_turn_over and self.is_behind
                self._handle_until(0.0 if is_due_alone else end_s)
            self._connection.end_turn()
        except Exception as error:  # noqa: BLE001  # a bug of ours: the others are unharmed
            self.drop()
            self._connection.fail(error)
        now_s = time.monotonic()
        cost_s, self._cost_s = self._cost_s, 0.0
        self._pay(now_s - start_s + cost_s, now_s)
        self._read_on()

    def _pay(self, spent_s: float, now_s: float) -> None:
        """Pay for a slice, and have the rest handled when there is time."""
        may_go_on = self._spending.spend(spent_s, now_s) or self._may_drive()
        self.is_behind = not may_go_on
        if not (may_go_on or self._is_waiting or self._is_turn_over) and self._head is None:
            self._is_waiting = True
            self._spending.wait(self.go_on)
        # a large message that is being read does not wait for the budget, because it takes memory
        if (self and not self._is_waiting) or self._can_look_ahead():
            self._spending.turns.add(self)

    def _read_on(self) -> None:
        """Read again if there is room. Note whether the next input may have waited."""
        if self._is_at_end and not self:
            self._transport.close()
        if self._is_at_end or self._transport.is_closing():
            return
        is_left = bool(self) or self._is_waiting
        if is_left and self._late_since_s is None:
            self._late_since_s = self._read_s
        if self._has_no_room():
            self._pause()
        elif self.is_paused:
            self.is_paused = False
            self._transport.resume_reading()
        if not (is_left or self._is_catching_up or self._late_since_s is None):
            self._is_catching_up = True
            self._catch_up(EMPTY_TURNS)

    def _has_no_room(self) -> bool:
        if self.is_behind:  # otherwise the waiting input is handled before more is read
            return bool(self._unparsed) or self._is_full() or self._is_ignored
        return bool(self)

    def _pause(self) -> None:
        if not self.is_paused and not self._transport.is_closing():
            self.is_paused = True
            self._transport.pause_reading()

    def _catch_up(self, turns: int) -> None:
        """Note that nothing is late any more, if no read is full for some turns of the loop."""
        if self.is_paused or self._is_waiting:  # a read that is full pauses
            self._is_catching_up = False  # the next turn of this client begins again
        elif turns > 0 or (turns == 0 and self):  # the last one's input is handled next
            asyncio.get_running_loop().call_soon(self._catch_up, turns - 1)
        else:
            self._is_catching_up = False
            self._late_since_s = None

    def _drives(self) -> bool:
        session = self._connection.session
        return session is not None and session.drives

    def _may_drive(self) -> bool:
        """Return whether a driver has time of its budget, even if its address has none."""
        return not self._spending.is_in_debt and self._drives()

    # What waits

    def _is_full(self) -> bool:
        return len(self._events) >= MAX_AHEAD or self._ahead_bytes >= MAX_AHEAD_BYTES

    def _can_look_ahead(self) -> bool:
        return bool(self._unparsed) and self._connection.session is not None and not self._is_full()

    def _look_ahead(self, end_s: float) -> None:
        """Parse the input, and carry out each `stop` in it before anything else."""
        while self._can_look_ahead():
            self._parse()
            if time.monotonic() > end_s:
                break
        was_open = self._connection.session is not None
        if self.is_behind and was_open and self._protocol.state is not OPEN:
            self._leave()

    def _handle_until(self, end_s: float) -> None:
        """Handle what waits until there is nothing or it is *end_s*, but at least one event."""
        self._is_turn_over = False
        while True:
            while self._events:
                self._handle(self._events.popleft())
                if self._events and (self._is_turn_over or time.monotonic() > end_s):
                    return
            self._ahead_bytes = 0
            self._connection.end_piece()
            if not self._unparsed or time.monotonic() > end_s:
                return
            self._parse()

    def _handle(self, event: Event | Callable[[], None]) -> None:
        if not self._overtaken:
            self._connection.handle(event)
            return
        self.is_overtaken = True
        self._connection.handle(event)  # may have some of it done in the next turn
        self._overtaken -= 1
        self.is_overtaken = False

    def _parse(self) -> None:
        """Parse the next piece. Carry out a `stop` in it, and keep what else there is."""
        piece = self._cut()
        self._ahead_bytes += len(piece)
        session = self._connection.session
        for event in self._reader.read(piece):
            if session is not None and _may_stop(event) and session.is_stop(bytes(event.data)):
                self._overtaken = max(self._overtaken, len(self._events))
                self._connection.handle(event)
            elif self._left_s is None or _is_lasting(event):
                self._events.append(event)

    def _leave(self) -> None:
        """Drop input of a client that has left, except its publishes. It no longer drives."""
        if self._left_s is None:
            self._left_s = time.monotonic()
            self._events = deque(filter(_is_lasting, self._events))
            self._overtaken = sys.maxsize

    def _cut(self) -> bytes:
        """Take the next unparsed piece. The first one ends with the HTTP request.

        `websockets` would parse frames behind a request that is not answered yet.
        """
        size = CHUNK_BYTES
        if self._head is not None:
            head = self._head + self._unparsed
            end = head.find(_END_OF_HEAD)
            size = len(self._unparsed) if end < 0 else end + len(_END_OF_HEAD) - len(self._head)
            self._head = head[1 - len(_END_OF_HEAD) :] if end < 0 else None
        piece, self._unparsed = self._unparsed[:size], self._unparsed[size:]
        return piece


def _may_stop(event: Event) -> TypeGuard[Frame]:
    """Return whether an event may be a `stop`: a message in one frame, with that word in it."""
    return (
        isinstance(event, Frame)
        and len(event.data) <= MAX_STOP_BYTES
        and b"stop" in event.data
        and event.fin
        and event.opcode is not Opcode.CONT
    )


def _is_lasting(event: Event | Callable[[], None]) -> bool:
    """Return whether an event of a client that has left is carried out: it may be a publish."""
    if not isinstance(event, Frame) or not event.fin or event.opcode is Opcode.CONT:
        return True
    return any(word in event.data for word in _LASTING)
