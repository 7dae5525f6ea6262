# SPDX-License-Identifier: Apache-2.0
"""The way of commands to a robot, over the relay's Zenoh session in the robot's namespace."""

import asyncio
import contextlib
import logging
from collections import deque
from collections.abc import Callable
from typing import Any, Final

import zenoh

from gateway.relay.driving import RemoteCommands
from gateway.relay.robot_link import OnTold
from gateway.sources.zenoh.driving_wire import (
    BEAT,
    COMMAND,
    CONTROL,
    LEASE,
    MAX_ANSWER_BYTES,
    STOP,
    TOKEN,
    RemoteCommand,
    RemoteOperation,
    RemoteStop,
    Told,
    client_of,
    read_beat,
    read_told,
)
from gateway.sources.zenoh.inbox import LoopWaker
from gateway.sources.zenoh.keys import WireError
from gateway.sources.zenoh.publishing import URGENT

ANSWER_S: Final = 2.0
MAX_ASKED: Final = 1024  # operations that wait for the robot's answer
MAX_WAITING: Final = 1024  # messages of the robot. The oldest make room

# for the log: as of one client, so that a flood of lines is limited
_OF_ROBOT: Final = {"client": "robot"}

logger = logging.getLogger(__name__)


class ZenohRobotLink:
    """Implements `gateway.relay.robot_link.RobotLink`. Lives on the event loop's thread."""

    def __init__(self, session: Any, commands: RemoteCommands) -> None:
        """Use a session, which this does not close."""
        self.relay = str(session.info.zid())
        self._session = session
        self._commands = commands
        self._tokens: dict[str, Any] = {}
        self._subscribers: list[Any] = []
        self._beat: bytes | None = None
        self._told: deque[tuple[str, bytes]] = deque(maxlen=MAX_WAITING)
        self._answers: deque[Callable[[], None]] = deque()  # one for each that is asked
        self._asked = 0
        self._is_closed = False
        self._options: dict[str, Any] = {
            "priority": URGENT,  # before pictures
            "congestion_control": zenoh.CongestionControl.DROP,
            "express": True,
        }
        self._waker = LoopWaker(asyncio.get_running_loop(), self._take)

    def ask(self, operation: RemoteOperation | RemoteStop, on_told: OnTold) -> None:
        """Send an operation. *on_told* gets the answer, or None after a while without one."""
        is_stop = isinstance(operation, RemoteStop)
        if self._asked >= MAX_ASKED and not is_stop:
            on_told(None)
            return
        self._asked += 1
        answers: list[bytes] = []

        def arrive(reply: Any) -> None:  # on a thread of Zenoh
            told = reply.ok
            if told is not None and not answers and len(told.payload) <= MAX_ANSWER_BYTES:
                answers.append(told.payload.to_bytes())

        def over() -> None:  # on a thread of Zenoh
            self._answers.append(lambda: self._answer(answers, on_told))
            self._waker.wake()

        try:
            self._session.get(
                STOP if is_stop else LEASE,
                zenoh.handlers.Callback(arrive, over, indirect=False),
                payload=operation.packed,
                timeout=ANSWER_S,
                **self._options,
            )
        except zenoh.ZError as error:
            _log("an operation was not sent to the robot: %s", error)
            self._asked -= 1
            on_told(None)

    def send(self, client: str, command: RemoteCommand) -> None:
        """Send a command. One that finds no room is lost: the next one is newer."""
        try:
            self._session.put(f"{COMMAND}/{client}", command.packed, **self._options)
        except zenoh.ZError as error:
            _log("a command was not sent to the robot: %s", error)

    def show(self, client: str) -> None:
        """Show the robot that a client is there, from now on or again.

        If Zenoh refuses, the robot sends the client away after a second.
        """
        self.hide(client)
        try:
            token = self._session.liveliness().declare_token(f"{TOKEN}/{client}")
        except zenoh.ZError as error:
            _log("a client was not shown to the robot: %s", error)
        else:
            self._tokens[client] = token

    def hide(self, client: str) -> None:
        """Show the robot that a client is gone."""
        token = self._tokens.pop(client, None)
        if token is not None:
            with contextlib.suppress(zenoh.ZError):  # the others are still to be hidden
                token.undeclare()

    def listen(self, *, is_on: bool) -> None:
        """Begin or end to get beats and states."""
        if is_on == bool(self._subscribers) or self._is_closed:
            return
        if is_on:
            try:
                self._subscribers = [
                    self._subscribe(BEAT, self._on_beat),
                    self._subscribe(CONTROL, self._on_told),
                    self._subscribe(f"{CONTROL}/{self.relay}/*", self._on_told),
                ]
            except zenoh.ZError as error:  # the next client tries again
                _log("Zenoh does not listen to the robot: %s", error)
            return
        subscribers, self._subscribers = self._subscribers, []
        for each in subscribers:
            with contextlib.suppress(zenoh.ZError):
                each.undeclare()

    def close(self) -> None:
        """Hide all clients, and get nothing any more."""
        for client in list(self._tokens):
            self.hide(client)
        self.listen(is_on=False)
        self._is_closed = True
        self._waker.close()

    def _subscribe(self, key: str, arrive: Callable[[Any], None]) -> Any:
        handler = zenoh.handlers.Callback(arrive, indirect=False)  # so that all keep their order
        return self._session.declare_subscriber(key, handler)

    # On threads of Zenoh

    def _on_beat(self, sample: Any) -> None:
        self._beat = sample.payload.to_bytes() if len(sample.payload) <= 64 else b""
        self._waker.wake()

    def _on_told(self, sample: Any) -> None:
        payload = sample.payload
        data = payload.to_bytes() if len(payload) <= MAX_ANSWER_BYTES else b""
        self._told.append((str(sample.key_expr), data))
        self._waker.wake()

    # On the loop

    def _take(self) -> None:
        try:
            self._take_all()
        except Exception:  # our bug: the others go on
            logger.exception("a message of a robot was not taken")
            self._waker.wake()

    def _take_all(self) -> None:
        beat, self._beat = self._beat, None
        if beat is not None:
            self._read(lambda: self._commands.hear_beat(read_beat(beat)))
        for _ in range(len(self._answers)):
            self._answers.popleft()()
        for _ in range(len(self._told)):
            key, data = self._told.popleft()
            self._read(lambda: self._hear(key, data))  # noqa: B023  # at once

    def _hear(self, key: str, data: bytes) -> None:
        client = "" if key == CONTROL else client_of(key)
        self._commands.hear(client, read_told(data))

    def _answer(self, answers: list[bytes], on_told: OnTold) -> None:
        self._asked -= 1
        told: list[Told] = []
        for answer in answers:
            self._read(lambda: told.append(read_told(answer)))  # noqa: B023  # at once
        on_told(told[0] if told else None)

    def _read(self, read: Callable[[], None]) -> None:
        try:
            read()
        except WireError as error:
            self._commands.relayed.note_malformed()
            _log("a message that no robot sends is left out: %s", error)


def _log(text: str, error: Exception) -> None:
    logger.warning(text, str(error)[:200], extra=_OF_ROBOT)
