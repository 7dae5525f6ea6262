# SPDX-License-Identifier: Apache-2.0
"""The gateway as people start it: a process, its address read from what it prints."""

import asyncio
import contextlib
import re
import signal
import sys
from asyncio.subprocess import PIPE, Process
from collections.abc import AsyncIterator, Sequence
from dataclasses import dataclass, field

STARTUP_S = 180  # a busy machine imports for a while
SHUTDOWN_S = 120

# arguments with which a client may take all of the gateway's time
ALL_TIME = ("--set", "limits.client_time_share=1", "--set", "limits.address_time_share=1")

_ADDRESS = re.compile(r"wss?://[^\s\"]+")


@dataclass
class GatewayProcess:
    """A running ``ros2-gateway serve`` or ``demo``."""

    process: Process
    url: str
    output: list[str] = field(default_factory=list)
    log: list[str] = field(default_factory=list)

    async def stop(self, number: signal.Signals = signal.SIGINT) -> int:
        """End it as Ctrl-C does, and return its exit code."""
        if self.process.returncode is None:
            self.process.send_signal(number)
        async with asyncio.timeout(SHUTDOWN_S):
            return await self.process.wait()


@contextlib.asynccontextmanager
async def gateway_process(
    command: str = "serve",
    *arguments: str,
    module: str = "tests.patient_gateway",
    before: Sequence[str] = (),
    program: Sequence[str] = (),
) -> AsyncIterator[GatewayProcess]:
    """Run ``ros2-gateway COMMAND``, or another *module*, on a free port until the context ends.

    *before* is a command that executes the one which follows it. *program* is run as it is, in
    place of the command.
    """
    run = program or (*before, sys.executable, "-m", module, command)
    process = await asyncio.create_subprocess_exec(
        *(*run, "--port", "0", *arguments),
        stdout=PIPE,
        stderr=PIPE,
    )
    gateway = GatewayProcess(process, "")
    async with asyncio.TaskGroup() as readers:
        readers.create_task(_follow(process.stderr, gateway.log))
        try:
            async with asyncio.timeout(STARTUP_S):
                while not gateway.url:
                    assert process.stdout is not None
                    line = (await process.stdout.readline()).decode()
                    assert line, f"the gateway ended while starting: {''.join(gateway.log)}"
                    gateway.output.append(line)
                    if found := _ADDRESS.search(line):
                        gateway.url = found[0]
            readers.create_task(_follow(process.stdout, gateway.output))
            yield gateway
        finally:
            await gateway.stop()


async def _follow(stream: asyncio.StreamReader | None, lines: list[str]) -> None:
    assert stream is not None
    async for line in stream:
        lines.append(line.decode(errors="replace"))  # noqa: PERF401  # readers want it now
