# SPDX-License-Identifier: Apache-2.0
"""Start the programs of the soak, ask them and end them."""

import asyncio
import contextlib
import json
import os
import signal
import sys
from asyncio.subprocess import PIPE, Process
from collections.abc import AsyncIterator, Sequence
from typing import Any, Final

ANSWER_S: Final = 180.0  # a busy machine imports rclpy for a while
END_S: Final = 20.0
LINE_BYTES: Final = 64 * 1024**2  # the report of ten hours


class Actor:
    """A process that takes orders by its standard input."""

    def __init__(self, name: str, process: Process) -> None:
        self.name = name
        self.process = process
        self._one_at_a_time = asyncio.Lock()

    async def answer(self) -> Any:
        """Return the next answer."""
        async with asyncio.timeout(ANSWER_S):
            line = await self.process.stdout.readline()
        if not line:
            raise RuntimeError(f"{self.name} has ended unexpectedly")
        return json.loads(line)

    async def ask(self, order: str) -> Any:
        """Give an order and return the answer."""
        async with self._one_at_a_time:
            self.process.stdin.write(f"{order}\n".encode())
            return await self.answer()

    def signal(self, number: signal.Signals) -> None:
        """Send a signal, unless it has ended."""
        if self.process.returncode is None:
            with contextlib.suppress(ProcessLookupError):
                # not by asyncio, which would take the exit code of who has just ended from itself
                os.kill(self.process.pid, number)

    async def end(self) -> None:
        """End it by the end of its standard input, or by force. Ending twice is harmless."""
        self.signal(signal.SIGCONT)
        self.process.stdin.close()
        try:
            async with asyncio.timeout(END_S):
                await self.process.wait()
        except TimeoutError:
            sys.stderr.write(f"{self.name} does not end, killing it\n")
        finally:
            if self.process.returncode is None:
                self.signal(signal.SIGKILL)
                await self.process.wait()


@contextlib.asynccontextmanager
async def acting(
    program: str, *arguments: object, name: str = "", before: Sequence[str] = ()
) -> AsyncIterator[Actor]:
    """Run a program of `tests.soak.actors` until the context ends. It has said that it is ready.

    *before* is a command that runs it somewhere else, such as in another network.
    """
    process = await asyncio.create_subprocess_exec(
        *before,
        *(sys.executable, "-m", f"tests.soak.actors.{program}", *map(str, arguments)),
        stdin=PIPE,
        stdout=PIPE,
        limit=LINE_BYTES,
        start_new_session=True,  # Ctrl-C reaches the soak, which ends it
    )
    actor = Actor(name or program, process)
    try:
        assert await actor.answer() == "ready"
        yield actor
    finally:
        await actor.end()
