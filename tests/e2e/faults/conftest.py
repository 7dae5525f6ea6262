# SPDX-License-Identifier: Apache-2.0
"""How often each fault is injected, how exact its bound is, and the table of what was measured.

``make faults REPEAT=20`` injects each 20 times, on an otherwise idle machine, with the
bounds of docs/reference/reaction-times.md. Without, each is injected twice with bounds for a
machine that is busy.
"""

import os
from collections import defaultdict

import pytest

REPEAT = int(os.environ.get("FAULTS_REPEAT", "2"))
BUSY = int(os.environ.get("FAULTS_BUSY", "0"))  # processes that want a core each, in some tests
IS_MEASURED = "FAULTS_REPEAT" in os.environ
IS_EXACT = IS_MEASURED and not BUSY
LENIENCE = 10  # of what the machine takes, beyond the deadline, where it is busy

_measured: dict[str, list[float]] = defaultdict(list)
_bounds: dict[str, float] = {}


@pytest.fixture
def measured():
    """Return a function that notes a reaction in seconds, and checks it."""

    def note(fault: str, took_s: float, *, allowed_s: float, after_s: float = 0.0) -> None:
        _measured[fault].append(took_s)
        _bounds[fault] = after_s + allowed_s
        assert took_s <= after_s + (allowed_s if IS_EXACT else LENIENCE * allowed_s + 1)

    return note


def pytest_terminal_summary(terminalreporter) -> None:
    if not _measured:
        return
    write = terminalreporter.write_line
    write("| event | zero seen within | median | slowest | times |")
    write("|---|---|---|---|---|")
    for fault, times in _measured.items():
        ordered = sorted(times)
        median, slowest = ordered[len(ordered) // 2], ordered[-1]
        bound = _bounds[fault] * 1000
        write(
            f"| {fault} | {bound:.0f} ms | {median * 1000:.0f} ms | {slowest * 1000:.0f} ms"
            f" | {len(times)} |"
        )
