# SPDX-License-Identifier: Apache-2.0
"""The gateway's side of the guard process: starts it, talks to it, replaces it."""

import asyncio
import contextlib
import itertools
import logging
import os
import subprocess
import sys
import time
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import orjson
from typing_extensions import Self

from gateway.drive.effects import GuardState
from gateway.faults import Fault
from gateway.guard import MARGIN_S, MAX_LINE_BYTES, MAX_READERS, REPEAT_S

RESTART_S: Final = 0.5  # doubled each time, up to
MAX_RESTART_S: Final = 30.0
STABLE_S: Final = 60.0  # after so long a restart is the first one again
# A guard that gets messages all the time answers ten times a second.
UNANSWERED_S: Final = 1.0
# It imports rclpy and joins DDS: one second, on a busy machine ten. Then it opens topics.
PREPARE_S: Final = 30.0
END_S: Final = 0.7  # with the clients' closing handshakes, less than the 2 s of a shutdown

logger = logging.getLogger(__name__)

OnState = Callable[[GuardState], None]


@dataclass(slots=True)
class _Topic:
    type_name: str
    readers: Sequence[str]
    on_state: OnState
    number: int  # of the `open`: an answer to an earlier one is too old
    sent_ns: int = 0  # the newest `moving`
    is_opening: bool = False


class GuardProcess:
    """One guard process at a time, on the running loop. Implements `gateway.sources.guard.Guard`.

    Nothing here waits: if the pipe does not take a line at once, the guard is not there.
    """

    def __init__(self, node_class: str, node: Mapping[str, object], *, deadline_s: float) -> None:
        """*node_class* is a `gateway.sources.guard.GuardNode`, and *node* its arguments."""
        silence_ns = round((deadline_s + MARGIN_S) * 1e9)
        options = {"class": node_class, "node": node, "silence_ns": silence_ns}
        self.command: Sequence[str] = (
            *(sys.executable, "-m", "gateway.guard"),
            orjson.dumps(options).decode(),
        )
        self._topics: dict[str, _Topic] = {}
        self._numbers = itertools.count()
        self._process: subprocess.Popen[bytes] | None = None
        self._why_lost: str | None = None
        self.is_ready = False  # once it has said so, until it is lost
        self.losses = 0
        self._rest = b""
        self._started_s = 0.0
        self._restart_s = RESTART_S
        self._restart: asyncio.TimerHandle | None = None
        self._asked_ns: int | None = None  # since when nothing has been answered
        self._wrote_ns = 0
        self._overdue: asyncio.TimerHandle | None = None  # while it prepares
        self._killed: list[subprocess.Popen[bytes]] = []  # not yet waited for

    @property
    def pid(self) -> int | None:
        """The process id, while there is one."""
        return self._process.pid if self._process else None

    def faults(self) -> Sequence[Fault]:
        """Return why commands to move are refused, if they are."""
        why = self._why_lost
        if why is None:
            return ()
        text = f"the guard process {why}: commands to move are refused until another is ready"
        return (Fault("degraded", text),)

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(self, *_: object) -> None:
        """End the guard: its input ends, and nothing moves any more."""
        if self._restart:
            self._restart.cancel()
        for killed in self._killed:
            killed.wait()
        process = self._process
        if process is None:
            return
        self._forget()
        with contextlib.suppress(subprocess.TimeoutExpired):
            await asyncio.get_running_loop().run_in_executor(None, process.wait, END_S)
        process.kill()
        process.wait()

    def start(self) -> None:
        """Start the process. Commands to move wait until it is ready."""
        self._restart = None
        self._killed = [each for each in self._killed if each.poll() is None]
        self._started_s = time.monotonic()
        try:
            self._process = process = subprocess.Popen(
                self.command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                start_new_session=True,  # Ctrl-C in a terminal is for the gateway
            )
        except OSError as error:
            self._lose(f"cannot be started: {error.strerror}")
            return
        for pipe in (process.stdin, process.stdout):
            os.set_blocking(_fd(pipe), False)
        asyncio.get_running_loop().add_reader(_fd(process.stdout), self._read)
        self._expect()

    # For the command topics

    def open(self, topic: str, type_name: str, readers: Collection[str], on_state: OnState) -> None:
        """Have the guard prepare for a topic. *on_state* is called when it has, or is lost."""
        some = sorted(readers)[:MAX_READERS]
        self._topics[topic] = _Topic(type_name, some, on_state, next(self._numbers))
        if self.is_ready:
            self._open(topic)
        elif self._restart is not None:
            on_state("lost")  # until another one starts, which may take a while

    def prove(self, topic: str, stamp_offset_ns: int, frame_id: str) -> None:
        """Have the guard prove that its zeros arrive, before something moves."""
        if topic in self._topics:
            self._ask("prove", topic, stamp_offset_ns, frame_id)

    def close(self, topic: str) -> None:
        """Have the guard forget a topic."""
        if self._topics.pop(topic, None) is not None and self.is_ready:
            self._write("close", topic)

    def moving(self, topic: str, stamp_offset_ns: int, frame_id: str) -> None:
        """Announce a command to move, before it goes out."""
        known = self._topics.get(topic)
        now_ns = time.monotonic_ns()
        if known is None or now_ns - known.sent_ns < REPEAT_S * 1e9:
            return
        known.sent_ns = now_ns
        self._ask("moving", topic, stamp_offset_ns, frame_id)

    def rest(self, topic: str) -> None:
        """Announce that the last zero has gone out."""
        known = self._topics.get(topic)
        if known is not None:
            known.sent_ns = 0
            self._write("rest", topic)

    # The pipes

    def _open(self, topic: str) -> None:
        known = self._topics[topic]
        known.is_opening = True
        if self._overdue is None:
            self._expect()
        self._write("open", topic, known.type_name, known.number, *known.readers)

    def _expect(self) -> None:
        """Expect an answer while the process starts or opens a topic. Replace one that hangs."""
        if self._overdue:
            self._overdue.cancel()
            self._overdue = None
        is_preparing = not self.is_ready or any(each.is_opening for each in self._topics.values())
        if self._process is not None and is_preparing:
            what = "opened a topic" if self.is_ready else "become ready"
            why = f"has not {what} within {PREPARE_S:g} s"
            loop = asyncio.get_running_loop()
            self._overdue = loop.call_later(PREPARE_S, self._lose, why)

    def _ask(self, *message: object) -> None:
        """Write what is repeated often, unless the guard answers nothing: then it is lost."""
        now_ns = time.monotonic_ns()
        if now_ns - self._wrote_ns > UNANSWERED_S * 1e9 / 2:
            self._asked_ns = None  # it got no message, and owes no answer
        if self._asked_ns is None:
            self._asked_ns = now_ns
        elif now_ns - self._asked_ns > UNANSWERED_S * 1e9:
            self._lose(f"has not answered for {UNANSWERED_S:g} s")
            return
        self._write(*message)

    def _write(self, *message: object) -> None:
        if self._process is None:
            return
        line = orjson.dumps(message) + b"\n"
        try:
            # less than PIPE_BUF, so it is written as a whole or not at all
            os.write(_fd(self._process.stdin), line)
        except OSError:  # full, or closed
            self._lose("no longer reads its input")
        self._wrote_ns = time.monotonic_ns()

    def _read(self) -> None:
        process = self._process
        if process is None:
            return
        try:
            data = os.read(_fd(process.stdout), 65536)
        except BlockingIOError:
            return
        if not data:
            self._lose("has ended")
            return
        self._asked_ns = None
        *lines, self._rest = (self._rest + data).split(b"\n")
        if len(self._rest) > MAX_LINE_BYTES:
            self._lose("writes nonsense")
            return
        try:
            messages = [orjson.loads(line) for line in lines]
        except orjson.JSONDecodeError:
            self._lose("writes nonsense")
            return
        for message in messages:
            self._hear(message)
        if self._overdue:  # any answer proves that it does not hang
            self._expect()

    def _hear(self, message: list[Any]) -> None:
        match message:
            case ["ready"]:
                self.is_ready = True
                self._why_lost = None
                logger.debug("the guard process is ready")
                for topic in list(self._topics):
                    self._open(topic)
            case ["opened" | "proved" as verb, topic, number] if topic in self._topics:
                if number == self._topics[topic].number:
                    self._topics[topic].is_opening = False
                    self._topics[topic].on_state("prepared" if verb == "opened" else "ready")
            case ["failed", topic, reason] if topic in self._topics:
                extra = {"topic": topic}
                logger.error("the guard process cannot guard this topic: %s", reason, extra=extra)
                self._topics[topic].is_opening = False
                self._topics[topic].on_state("lost")
            case ["cut off"]:
                self._lose("finds that commands do not get through to the robot")
            case ["stopped", topic]:
                extra = {"topic": topic}
                logger.warning("the guard process stopped the robot: the gateway hung", extra=extra)

    def _lose(self, why: str) -> None:
        """Give up the process, stop what moves, and start another a little later."""
        process = self._process
        self._why_lost = why
        self.losses += 1
        if process is not None:
            self._forget()
            process.kill()
            if process.poll() is None:
                # killed, and so gone in no time, but it must not stay as a zombie
                self._killed.append(process)
        if time.monotonic() - self._started_s > STABLE_S:
            self._restart_s = RESTART_S
        logger.error(
            "the guard process %s: commands to move are refused until another is ready", why
        )
        self._restart = asyncio.get_running_loop().call_later(self._restart_s, self.start)
        self._restart_s = min(2 * self._restart_s, MAX_RESTART_S)
        for known in list(self._topics.values()):
            known.on_state("lost")

    def _forget(self) -> None:
        """Close both pipes of the process."""
        process, self._process = self._process, None
        if self._overdue:
            self._overdue.cancel()
            self._overdue = None
        self.is_ready = False
        self._asked_ns = None
        self._rest = b""
        if process is not None:
            asyncio.get_running_loop().remove_reader(_fd(process.stdout))
            for pipe in (process.stdin, process.stdout):
                if pipe is not None:
                    with contextlib.suppress(OSError):
                        pipe.close()


def _fd(pipe: Any) -> int:
    return int(pipe.fileno())
