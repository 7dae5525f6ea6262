# SPDX-License-Identifier: Apache-2.0
"""Start, measure and end the processes of a benchmark."""

import contextlib
import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

_TICKS_PER_S = os.sysconf("SC_CLK_TCK")


@dataclass(frozen=True)
class Receipt:
    """What one receiver saw, and what the process under test spent meanwhile."""

    rate_hz: float
    p50_ms: float
    p90_ms: float
    p99_ms: float
    cpu_us_per_message: float
    memory_mb: float


def cpu_s(pid: int) -> float:
    """Return the user and system time that a process has used."""
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / _TICKS_PER_S


def memory_mb(pid: int) -> float:
    """Return what of a process is in memory."""
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


@contextlib.contextmanager
def running(*command: str) -> Iterator[subprocess.Popen[str]]:
    """Run ``python -m COMMAND`` and end it as Ctrl-C does."""
    process = subprocess.Popen([sys.executable, "-m", *command], stdout=subprocess.PIPE, text=True)
    try:
        yield process
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
        process.communicate(timeout=30)


def line_with(process: subprocess.Popen[str], pattern: str) -> str:
    """Return the first match in what a process prints."""
    assert process.stdout is not None
    for line in process.stdout:
        if found := re.search(pattern, line):
            return found[0]
    raise RuntimeError(f"the process ended without printing {pattern}")


def receive(receiver: subprocess.Popen[str], tested_pid: int, seconds: float) -> Receipt:
    """Let a receiver work for a while, and return what it saw and what that cost."""
    line_with(receiver, "ready")
    time.sleep(2)  # discovery, and code that is compiled at first use
    before, before_s = count(receiver), cpu_s(tested_pid)
    time.sleep(seconds)
    received, spent_s = count(receiver) - before, cpu_s(tested_pid) - before_s
    memory = memory_mb(tested_pid)
    receiver.send_signal(signal.SIGINT)
    seen = json.loads(line_with(receiver, r"\{.*\}"))
    receiver.wait(timeout=30)
    if received == 0:
        raise RuntimeError("nothing was received")
    ages = (seen["p50_ms"], seen["p90_ms"], seen["p99_ms"])
    return Receipt(received / seconds, *ages, spent_s / received * 1e6, memory)


def count(receiver: subprocess.Popen[str]) -> int:
    """Return how many messages a receiver has got so far."""
    receiver.send_signal(signal.SIGUSR1)
    return int(line_with(receiver, r"count \d+").split()[1])
