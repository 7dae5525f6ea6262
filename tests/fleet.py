# SPDX-License-Identifier: Apache-2.0
"""The example with a fleet, as people start it."""

import asyncio
import contextlib
import re
import shutil
import signal
import sys
from asyncio.subprocess import PIPE, Process
from collections.abc import AsyncIterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.client import TIMEOUT_S
from tests.sources.zenoh.outside import free_port

ROOT = Path(__file__).parents[1]


@dataclass
class Fleet:
    """A fleet that runs."""

    url: str  # of the load balancer
    pids: dict[str, int]
    relays: dict[str, str]  # their addresses
    config: Path | None  # of nginx, with the relays


@contextlib.asynccontextmanager
async def started(balancer: str, *flags: str) -> AsyncIterator[Fleet]:
    """Start a fleet that ends with the context."""
    if shutil.which(balancer) is None:
        pytest.skip(f"{balancer} is not installed: run sh tools/make-balancers.sh")
    script = ("examples/fleet/start.py", "--port", str(free_port()), "--balancer", balancer)
    process = await asyncio.create_subprocess_exec(
        sys.executable, *script, *flags, stdout=PIPE, cwd=ROOT
    )
    try:
        text = "".join(await _lines_until(process, "ready:"))
        pids = {name: int(pid) for name, pid in re.findall(r"(\w+): process (\d+)", text)}
        relays = dict(re.findall(r"(relay\d): (http\S+)/\n", text))
        config = re.search(r"nginx: (/\S+)", text)
        [url] = re.findall(r"ready: (\S+)/\n", text)
        yield Fleet(url, pids, relays, Path(config[1]) if config else None)
    finally:
        process.send_signal(signal.SIGTERM)
        await process.communicate()
    assert process.returncode == 0


async def _lines_until(process: Process, wanted: str) -> list[str]:
    """Return what the script prints, up to a line."""
    assert process.stdout is not None
    lines: list[str] = []
    async with asyncio.timeout(2 * TIMEOUT_S):
        while not (lines and lines[-1].startswith(wanted)):
            line = (await process.stdout.readline()).decode()
            assert line, "".join(lines)
            lines.append(line)
    return lines
