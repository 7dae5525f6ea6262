# SPDX-License-Identifier: Apache-2.0
"""A network, a /dev/shm and processes of the soak's own: nobody else counts, nothing is left.

They are namespaces of Linux. All processes in them end with the soak, however it ends. They need
root. Without it, the soak is not isolated.
"""

import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from typing import Final

_UNSHARE: Final = (
    *("unshare", "--net", "--mount"),
    *("--pid", "--fork", "--kill-child", "--mount-proc"),
)
ISOLATED: Final = "SOAK_IS_ISOLATED"  # in the environment of who runs inside


def is_isolated() -> bool:
    """Return whether this process has a separate network and /dev/shm."""
    return ISOLATED in os.environ


def reason_against() -> str | None:
    """Return why there can be no isolation here, or ``None``."""
    if any(shutil.which(tool) is None for tool in ("unshare", "nsenter", "ip", "tc", "mount")):
        return "unshare, nsenter, ip, tc or mount is not installed"
    tried = subprocess.run(
        [*_UNSHARE, "mount", "-t", "tmpfs", "none", "/dev/shm"],  # noqa: S108
        capture_output=True,
        check=False,
    )
    return None if tried.returncode == 0 else "namespaces need root"


def enter(arguments: Sequence[str]) -> None:
    """Replace this process by one that runs `tests.soak` isolated."""
    os.environ[ISOLATED] = "1"
    sys.stdout.flush()
    command = (sys.executable, "-m", "tests.soak", *arguments)
    os.execvp("unshare", (*_UNSHARE, "--", *command))  # noqa: S606


def furnish() -> None:
    """Make what a new namespace lacks: a loopback interface that is up, an empty /dev/shm."""
    run("ip", "link", "set", "lo", "up")
    run("mount", "-t", "tmpfs", "none", "/dev/shm")  # noqa: S108


def run(*command: str) -> str:
    """Run a command and return what it prints."""
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"{' '.join(command)}: {done.stderr.strip()}")
    return done.stdout
