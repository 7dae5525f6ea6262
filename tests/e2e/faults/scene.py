# SPDX-License-Identifier: Apache-2.0
"""Robot, gateway, link and operator, each a process that can be stopped or killed."""

import asyncio
import contextlib
import re
import signal
import sys
import time
from asyncio.subprocess import PIPE, Process
from collections.abc import AsyncIterator, Sequence
from dataclasses import dataclass, field

START_S = 180  # a busy machine imports for a while
MOVES_FOR = 5  # commands that the robot has to hear before a fault, so that it surely moves
LATELY_NS = 300_000_000

_PORT = re.compile(r"wss?://\S+?:(\d+)")


@dataclass
class Base:
    """The commands that the robot has heard: times (monotonic) and speeds, oldest first."""

    process: Process
    heard: list[tuple[int, float]] = field(default_factory=list)

    def end(self, number: signal.Signals) -> None:
        """End it: by SIGINT it leaves the graph, by SIGKILL it stays there for 20 s."""
        self.process.send_signal(number)

    @property
    def is_running(self) -> bool:
        return self.process.returncode is None

    def zero_after(self, since_ns: int) -> int | None:
        """Return when the first zero came after a time, if one has come."""
        return next((at for at, speed in self.heard if at >= since_ns and not speed), None)

    def moved_after(self, since_ns: int) -> list[int]:
        """Return when commands to move came after a time."""
        return [at for at, speed in self.heard if at >= since_ns and speed]

    @property
    def last_moved_ns(self) -> int:
        return max((at for at, speed in self.heard if speed), default=0)

    @property
    def is_moving(self) -> bool:
        newest = self.heard[-MOVES_FOR:]
        is_recent = bool(newest) and time.monotonic_ns() - newest[-1][0] < LATELY_NS
        return len(newest) == MOVES_FOR and all(speed for _, speed in newest) and is_recent


async def until(condition, within_s: float = START_S) -> None:
    async with asyncio.timeout(within_s):
        while not condition():  # noqa: ASYNC110  # of anything, without its cooperation
            await asyncio.sleep(0.005)


@contextlib.asynccontextmanager
async def process(*arguments: str, before: Sequence[str] = ()) -> AsyncIterator[Process]:
    """Run a module of Python until the context ends, however it is then.

    *before* is a command that executes the one which follows it.
    """
    started = await asyncio.create_subprocess_exec(
        *before, sys.executable, "-m", *arguments, stdin=PIPE, stdout=PIPE
    )
    try:
        yield started
    finally:
        if started.returncode is None:
            with contextlib.suppress(ProcessLookupError):
                started.send_signal(signal.SIGCONT)
                started.kill()
        await started.wait()


async def line(started: Process) -> str:
    assert started.stdout is not None
    async with asyncio.timeout(START_S):
        return (await started.stdout.readline()).decode()


@contextlib.asynccontextmanager
async def base(
    before: Sequence[str] = (), command: Sequence[str] = ("tests.e2e.faults.robot",)
) -> AsyncIterator[Base]:
    """Run the robot."""

    async def listen(robot: Base) -> None:
        assert robot.process.stdout is not None
        async for text in robot.process.stdout:
            at_ns, speed = text.split()
            robot.heard.append((int(at_ns), float(speed)))

    async with process(*command, before=before) as started:
        assert await line(started) == "ready\n"
        robot = Base(started)
        listening = asyncio.create_task(listen(robot))
        try:
            yield robot
        finally:
            listening.cancel()


@dataclass
class Gateway:
    """A gateway that is to suffer."""

    process: Process
    port: int

    @property
    def url(self) -> str:
        return f"ws://127.0.0.1:{self.port}/"


@contextlib.asynccontextmanager
async def gateway(
    *arguments: str, before: Sequence[str] = (), command: str = "serve"
) -> AsyncIterator[Gateway]:
    """Run a gateway that can be hung."""
    hanging = ("tests.e2e.faults.hanging_gateway", command, "--port", "0")
    async with process(*hanging, *arguments, before=before) as started:
        while not (found := _PORT.search(await line(started))):
            pass
        yield Gateway(started, int(found[1]))


@contextlib.asynccontextmanager
async def link(port: int) -> AsyncIterator[tuple[Process, str]]:
    """Run a link to a port, and yield its process and its address."""
    async with process("tests.e2e.faults.link", "127.0.0.1", str(port)) as started:
        yield started, f"ws://127.0.0.1:{int(await line(started))}/"


@contextlib.asynccontextmanager
async def operator(url: str, before: Sequence[str] = ()) -> AsyncIterator[Process]:
    """Run an operator."""
    async with process("tests.e2e.faults.operator", url, before=before) as started:
        assert await line(started) == "ready\n"
        yield started


@dataclass
class Publisher:
    """A publisher that is to suffer, or to make others suffer."""

    process: Process

    async def publish(self, cdr: bytes) -> None:
        """Publish bytes, once."""
        await self._do(f"once {cdr.hex()}")

    async def repeat(self, cdr: bytes) -> None:
        """Publish bytes at 20 Hz, until it is told otherwise or dies."""
        await self._do(f"repeat {cdr.hex()}")

    async def end(self, number: signal.Signals) -> None:
        """End it: by SIGTERM it leaves the graph, by SIGKILL it stays there for 20 s."""
        self.process.send_signal(number)
        await self.process.wait()

    async def _do(self, text: str) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(f"{text}\n".encode())
        assert await line(self.process) == "done\n"


@contextlib.asynccontextmanager
async def publisher(
    topic: str, type_name: str, reliability: str = "reliable", before: Sequence[str] = ()
) -> AsyncIterator[Publisher]:
    """Run a publisher."""
    command = ("tests.e2e.faults.publisher", topic, type_name, reliability)
    async with process(*command, before=before) as started:
        assert await line(started) == "ready\n"
        yield Publisher(started)


async def until_it_moves(
    robot: Base, driver: Process, *, since_ns: int = 0, commands: int = MOVES_FOR
) -> None:
    """Wait until the robot moves and has heard so many commands since a time.

    The driver lets go of the stick whenever the latch has tripped, as on a machine that pauses.
    """

    def moves() -> bool:
        return robot.is_moving and len(robot.moved_after(since_ns)) >= commands

    async with asyncio.timeout(START_S):
        while True:
            try:
                await until(moves, within_s=3)
            except TimeoutError:
                driver.send_signal(signal.SIGUSR1)
            else:
                return
