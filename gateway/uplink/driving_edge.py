# SPDX-License-Identifier: Apache-2.0
"""Driving by clients of relays, at the Zenoh session of the robot's uplink.

Bounded queues keep all that arrives until the loop takes it. All commands that have come are
taken in one turn: of those that arrive together only the newest moves the robot. A stop has a
separate queue, which is never full: what is too much for it stops everything.
"""

import asyncio
import contextlib
import logging
import threading
from collections import deque
from collections.abc import Callable
from typing import Any, Final

import zenoh

from gateway.access.permissions import Identity
from gateway.core.router import Router
from gateway.sources.source import RosError
from gateway.sources.zenoh.driving_wire import (
    BEAT,
    COMMAND,
    CONTROL,
    LEASE,
    MAX_COMMAND_BYTES,
    MAX_OPERATION_BYTES,
    STOP,
    TOKEN,
)
from gateway.sources.zenoh.inbox import LoopWaker
from gateway.sources.zenoh.outgoing import Outgoing
from gateway.sources.zenoh.publishing import URGENT
from gateway.uplink.driving import OF_RELAYS, RemoteDrivers

BEAT_S: Final = 0.05
STATES_S: Final = 1.0
# Each is taken within a turn of the loop, or the oldest makes room
MAX_WAITING: Final = 256
MAX_WAITING_TOKENS: Final = 4096  # beyond, all clients have to enter again

logger = logging.getLogger(__name__)


class DrivingEdge:
    """Listens and answers until it is closed. Lives on the event loop's thread."""

    def __init__(self, router: Router, identity: Identity, session: Any) -> None:
        loop = asyncio.get_running_loop()
        self._session = session
        self.drivers = RemoteDrivers(router, identity, self._tell)
        self._commands: deque[tuple[str, bytes]] = deque(maxlen=MAX_WAITING)
        self._operations: deque[Any] = deque()
        self._stops: deque[Any] = deque()
        self._tokens: deque[tuple[str, bool]] = deque()
        self._stops_all = False  # a stop came that found no room
        self._has_missed_tokens = False
        self._is_connected = True
        self._is_closed = False
        self._waker = LoopWaker(loop, self._take)
        self._outgoing = Outgoing()  # a relay that reads nothing must not hold up the loop
        options = {"priority": URGENT, "congestion_control": zenoh.CongestionControl.DROP}
        self._told_by = options
        self._states_s = loop.time()
        self._loop = loop
        self._timer = loop.call_soon(self._on_time)
        with contextlib.ExitStack() as undo:
            undo.callback(self.close)
            self._beat = session.declare_publisher(BEAT, express=True, **options)
            self._control = session.declare_publisher(CONTROL, **options)
            self._declared = [
                self._beat,
                self._control,
                session.declare_queryable(LEASE, _at_once(self._on_operation)),
                session.declare_queryable(STOP, _at_once(self._on_stop)),
                session.declare_subscriber(f"{COMMAND}/*/*", _at_once(self._on_command)),
                session.liveliness().declare_subscriber(
                    f"{TOKEN}/*/*", _at_once(self._on_token), history=True
                ),
            ]
            undo.pop_all()

    def close(self) -> None:
        """Carry out the stops that wait, end all clients, and take nothing any more.

        The session is closed by its owner.
        """
        self._is_closed = True
        self._timer.cancel()
        self._waker.close()
        try:
            self._take_stops()
        finally:
            self.drivers.close()
        for query in self._operations:
            query.drop()
        # in a thread: it waits for a router that takes nothing, and the zeros of a stop go on
        threading.Thread(target=self._outgoing.close, name="driving_close", daemon=True).start()

    # On threads of Zenoh

    def _on_command(self, sample: Any) -> None:
        if len(sample.payload) > MAX_COMMAND_BYTES or len(self._commands) >= MAX_WAITING:
            self.drivers.counts.drop()
        if len(sample.payload) <= MAX_COMMAND_BYTES:
            self._commands.append((str(sample.key_expr), sample.payload.to_bytes()))
            self._waker.wake()

    def _on_operation(self, query: Any) -> None:
        if self._is_closed or len(self._operations) >= MAX_WAITING:
            self.drivers.counts.drop()
            query.drop()  # its relay finds out at once
            return
        self._operations.append(query)
        self._waker.wake()

    def _on_stop(self, query: Any) -> None:
        if self._is_closed or len(self._stops) >= MAX_WAITING:
            self._stops_all = True
            query.drop()
        else:
            self._stops.append(query)
        self._waker.wake()

    def _on_token(self, sample: Any) -> None:
        if len(self._tokens) >= MAX_WAITING_TOKENS:
            self._has_missed_tokens = True  # perhaps that a client is gone
            self.drivers.counts.drop()
        else:
            self._tokens.append((str(sample.key_expr), sample.kind == zenoh.SampleKind.PUT))
        self._waker.wake()

    # On the loop

    def _take(self) -> None:
        """Do all that has come: stops, tokens, operations, commands."""
        try:
            self._take_all()
        except Exception:  # our bug: it ends nothing else, least of all a stop that comes later
            logger.exception("an operation of a relay failed")
            self._waker.wake()

    def _take_stops(self) -> None:
        if self._stops_all:
            self._stops_all = False
            self.drivers.stop(b"{}")
        self._answer_all(self._stops, STOP, self.drivers.stop)

    def _take_all(self) -> None:
        self._take_stops()
        for _ in range(len(self._tokens)):
            key, is_there = self._tokens.popleft()
            self.drivers.follow_token(key, is_there=is_there)
        if self._has_missed_tokens:
            self._has_missed_tokens = False
            logger.warning("too many tokens of clients at a time: all enter again", extra=OF_RELAYS)
            self.drivers.cut_off()
        self._answer_all(self._operations, LEASE, self.drivers.operate)
        for _ in range(len(self._commands)):
            self.drivers.command(*self._commands.popleft())

    def _answer_all(
        self, queries: deque[Any], key: str, carry_out: Callable[[bytes], bytes]
    ) -> None:
        for _ in range(len(queries)):
            query = queries.popleft()
            payload = query.payload
            is_long = payload is not None and len(payload) > MAX_OPERATION_BYTES
            data = b"" if payload is None or is_long else payload.to_bytes()
            answer = carry_out(data)
            try:
                self._outgoing.send("answers to relays", len(answer), _reply(query, key, answer))
            except RosError as error:  # the relay finds out
                logger.warning("%s", error, extra=OF_RELAYS)
                query.drop()

    def _on_time(self) -> None:
        self._timer = self._loop.call_later(BEAT_S, self._on_time)
        is_connected = bool(self._session.info.routers_zid())
        if self._is_connected and not is_connected:
            logger.warning("the router is gone, so no client of a relay drives")
            self.drivers.cut_off()
        self._is_connected = is_connected
        if not is_connected:
            return
        self._put(self._beat.put, self.drivers.beat.packed)  # first: nothing delays it
        self.drivers.tick()
        if self._loop.time() - self._states_s >= STATES_S:
            self.drivers.tell_states()

    def _tell(self, client: str, data: bytes) -> None:
        if client:
            key = f"{CONTROL}/{client}"
            self._put(lambda payload: self._session.put(key, payload, **self._told_by), data)
        else:
            self._states_s = self._loop.time()
            self._put(self._control.put, data)

    def _put(self, put: Callable[[bytes], object], data: bytes) -> None:
        try:
            put(data)
        except zenoh.ZError as error:
            logger.warning("Zenoh did not send to relays: %s", str(error)[:200], extra=OF_RELAYS)


def _reply(query: Any, key: str, answer: bytes) -> Callable[[], None]:
    def send() -> None:
        query.reply(key, answer)  # with the priority of the query
        query.drop()

    return send


def _at_once(call: Callable[[Any], None]) -> Any:
    """Have a call made on the thread that receives, so that what comes keeps its order."""
    return zenoh.handlers.Callback(call, indirect=False)
