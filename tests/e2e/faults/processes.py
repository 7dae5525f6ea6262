# SPDX-License-Identifier: Apache-2.0
"""Processes as the kernel sees them, and their shared memory."""

import contextlib
import time
from pathlib import Path

from gateway.sources.rclpy.shared_memory import MIN_AGE_S
from tests.e2e.faults.scene import Gateway

SHARED_MEMORY = Path("/dev/shm")  # noqa: S108


def guard_of(gateway: Gateway) -> int:
    """Return the process id of a gateway's guard."""
    pid = gateway.process.pid
    children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    assert len(children) == 1
    return int(children[0])


def is_running(pid: int) -> bool:
    try:
        stat = Path(f"/proc/{pid}/stat").read_text()
    except (FileNotFoundError, ProcessLookupError):
        return False
    return stat.rpartition(")")[2].split()[0] != "Z"  # an orphan whom no init has reaped


def segments_of(pid: int) -> set[str]:
    """Return the shared memory that a process has locked as its own."""
    return {name for name in _shared(pid) if "port" not in name}


def ports_of(pid: int) -> set[str]:
    """Return the shared memory through which others reach a process."""
    return _shared(pid) - segments_of(pid)


def _shared(pid: int) -> set[str]:
    names = set()
    for descriptor in Path(f"/proc/{pid}/fd").iterdir():
        with contextlib.suppress(OSError):
            target = descriptor.readlink()
            if target.parent == SHARED_MEMORY and target.name.endswith("_el"):
                names.add(target.name.removesuffix("_el"))
    return names


def is_old(segment: str) -> bool:
    """Return whether a participant can no longer be about to take its lock."""
    return time.time() - (SHARED_MEMORY / f"{segment}_el").stat().st_mtime > MIN_AGE_S
