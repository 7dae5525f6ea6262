# SPDX-License-Identifier: Apache-2.0
"""Three minutes of what ``make soak`` does for hours, judged for a machine that is busy."""

import asyncio
import sys
from asyncio.subprocess import PIPE, STDOUT
from pathlib import Path

import pytest

FILE = Path(__file__).name
MINUTES = 3


@pytest.mark.timeout(1800)  # a busy machine starts a dozen processes for a while
async def test_minutes_of_load_and_disturbances_leave_the_gateway_as_it_was():
    process = await asyncio.create_subprocess_exec(
        *(sys.executable, "-m", "tests.soak", str(MINUTES), "--lenient"),
        stdout=PIPE,
        stderr=STDOUT,
    )
    output, _ = await process.communicate()
    assert process.returncode == 0, output.decode(errors="replace")
    sys.stdout.write(output.decode(errors="replace"))  # pytest -s and -rP show the figures
