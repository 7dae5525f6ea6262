# SPDX-License-Identifier: Apache-2.0
"""The example with a fleet: robots, router, two relays, and HAProxy, started by one script."""

import asyncio
import contextlib
import os
import re
import shutil
import signal
import sys
from asyncio.subprocess import PIPE, Process
from pathlib import Path

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus

from tests.client import TIMEOUT_S, client
from tests.sources.zenoh.outside import free_port

ROOT = Path(__file__).parents[2]

pytestmark = pytest.mark.skipif(
    shutil.which("haproxy") is None, reason="haproxy is not installed: run sh tools/make-haproxy.sh"
)


async def lines_until(process: Process, wanted: str) -> list[str]:
    """Return what the script prints, up to a line."""
    assert process.stdout is not None
    lines: list[str] = []
    async with asyncio.timeout(2 * TIMEOUT_S):
        while not (lines and lines[-1].startswith(wanted)):
            line = (await process.stdout.readline()).decode()
            assert line, "".join(lines)
            lines.append(line)
    return lines


async def watch(url: str) -> None:
    """Get a message, sooner or later: a client tries again when its relay has ended."""
    async with asyncio.timeout(TIMEOUT_S):
        while True:
            try:
                async with client(url) as viewer:
                    await viewer.send(op="subscribe", topic="/odom")
                    await viewer.message("/odom")
                    return
            except (ConnectionClosed, InvalidStatus, OSError):
                await asyncio.sleep(0.1)


async def test_viewers_see_the_robots_and_find_the_other_relay_when_theirs_ends():
    script = ("examples/fleet/start.py", "--port", str(port := free_port()), "--robots", "2")
    process = await asyncio.create_subprocess_exec(sys.executable, *script, stdout=PIPE, cwd=ROOT)
    try:
        lines = await lines_until(process, "ready:")
        pids = dict(re.findall(r"(\w+): process (\d+)", "".join(lines)))
        url = f"ws://127.0.0.1:{port}"
        for path in ("/r1/", "/?robot=r1", "/r2/"):
            await watch(f"{url}{path}")
        await end(int(pids["relay1"]))
        for path in ("/r1/", "/r2/"):
            await watch(f"{url}{path}")
    finally:
        process.send_signal(signal.SIGTERM)
        await process.communicate()
    assert process.returncode == 0


async def end(pid: int) -> None:
    """End a process, and wait until it is gone."""
    os.kill(pid, signal.SIGTERM)
    async with asyncio.timeout(TIMEOUT_S):
        with contextlib.suppress(ProcessLookupError):
            while True:
                os.kill(pid, 0)
                await asyncio.sleep(0.1)
