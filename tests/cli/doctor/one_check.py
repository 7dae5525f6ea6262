# SPDX-License-Identifier: Apache-2.0
"""One check of the doctor in a process: ``python -m tests.cli.doctor.one_check NAME``.

It prints each finding as its level and what happened. A test starts it in a namespace, or as
another user.
"""

import os
import subprocess
import sys
from pathlib import Path

from gateway.cli.doctor.finding import Finding
from gateway.cli.doctor.local_checks import CHECKS
from gateway.cli.doctor.machine import Machine
from gateway.config.model import Config

TIMEOUT_S = 180


def found(name: str, *before: str, **environment: str) -> list[str]:
    """Return the findings of a check in a process that the command *before* executes."""
    finished = subprocess.run(
        [*before, sys.executable, "-m", __name__, name],
        cwd=Path(__file__).parents[3],
        env=os.environ | environment,
        capture_output=True,
        text=True,
        timeout=TIMEOUT_S,
        check=False,
    )
    assert finished.returncode == 0, finished.stderr
    return finished.stdout.splitlines()


if __name__ == "__main__":
    for each in CHECKS[sys.argv[1]](Machine(Config(), os.environ, TIMEOUT_S)):
        if isinstance(each, Finding):
            print(f"{each.level}: {each.what}")  # noqa: T201  # for the test
