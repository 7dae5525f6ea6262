# SPDX-License-Identifier: Apache-2.0
"""Processes as the kernel sees them."""

from pathlib import Path

from tests.e2e.faults.scene import Gateway


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
