# SPDX-License-Identifier: Apache-2.0
"""Three minutes of what ``make soak`` does for hours, judged for a machine that is busy."""

import asyncio
import contextlib
import signal
import sys
from asyncio.subprocess import PIPE, STDOUT
from pathlib import Path

import pytest

FILE = Path(__file__).name
MINUTES = 3
CLEAN_UP_S = 60


@pytest.mark.timeout(1800)  # a busy machine starts a dozen processes for a while
async def test_minutes_of_load_and_disturbances_leave_the_gateway_as_it_was():
    process = await asyncio.create_subprocess_exec(
        *(sys.executable, "-m", "tests.soak", str(MINUTES), "--lenient"),
        stdout=PIPE,
        stderr=STDOUT,
    )
    try:
        output, _ = await process.communicate()
    finally:
        if process.returncode is None:
            process.send_signal(signal.SIGINT)
            with contextlib.suppress(TimeoutError):
                async with asyncio.timeout(CLEAN_UP_S):
                    await process.wait()
            with contextlib.suppress(ProcessLookupError):
                process.kill()
    assert process.returncode == 0, output.decode(errors="replace")
    sys.stdout.write(output.decode(errors="replace"))  # pytest -s and -rP show the figures
