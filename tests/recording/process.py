# SPDX-License-Identifier: Apache-2.0
"""``ros2-gateway record`` as people start it."""

import asyncio
import contextlib
import signal
import sys
from asyncio.subprocess import PIPE, Process
from collections.abc import AsyncIterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from tests.gateway_process import SHUTDOWN_S, STARTUP_S


@dataclass
class RecordProcess:
    """A recording that is under way."""

    process: Process
    folder: Path

    async def end(self, number: signal.Signals = signal.SIGINT) -> tuple[int, str]:
        """End it, and return the exit code and what it printed."""
        if self.process.returncode is None:
            self.process.send_signal(number)
        return await self.ended()

    async def ended(self) -> tuple[int, str]:
        """Wait until it has ended."""
        async with asyncio.timeout(SHUTDOWN_S):
            output, errors = await self.process.communicate()
        return self.process.returncode or 0, (output + errors).decode()

    @property
    def is_active(self) -> bool:
        """Return whether a file is incomplete."""
        return any(self.folder.glob("*.active"))

    @property
    def active(self) -> Path:
        """The file that is being written."""
        (path,) = self.folder.glob("*.active")
        return path


@contextlib.asynccontextmanager
async def record_process(
    directory: Path, *arguments: str, before: Sequence[str] = ()
) -> AsyncIterator[RecordProcess]:
    """Record into a directory until the context ends. *before* is a command that executes it."""
    process = await asyncio.create_subprocess_exec(
        *(*before, sys.executable, "-m", "gateway", "record", "-o", str(directory), *arguments),
        stdout=PIPE,
        stderr=PIPE,
    )
    try:
        assert process.stdout is not None
        async with asyncio.timeout(STARTUP_S):
            line = (await process.stdout.readline()).decode()
        text, _, _ = line.removeprefix("recording to ").partition(", ")
        assert line.startswith("recording to "), line
        yield RecordProcess(process, Path(text))
    finally:
        if process.returncode is None:
            process.kill()
        await process.wait()
