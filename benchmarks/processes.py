# SPDX-License-Identifier: Apache-2.0
"""Start, ask, measure and end the processes of a benchmark."""

import contextlib
import ctypes
import json
import os
import queue
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Final

from benchmarks.errors import BenchmarkError

_TICKS_PER_S: Final = os.sysconf("SC_CLK_TCK")
_LIBC: Final = ctypes.CDLL(None)
_ANSWER_S: Final = 30.0  # also for a start: rclpy, and making a picture of 1080p
_END_S: Final = 10.0


class Process:
    """A process in a separate session, so that Ctrl-C reaches the benchmark, which ends it."""

    def __init__(self, name: str, command: list[str], *, is_asked: bool) -> None:
        self.name = name
        self._popen = subprocess.Popen(
            command,
            stdin=subprocess.PIPE if is_asked else subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )
        self.pid: Final = self._popen.pid
        self._lines: queue.SimpleQueue[str | None] = queue.SimpleQueue()
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def send(self, *words: object) -> None:
        """Give an actor an order."""
        assert self._popen.stdin is not None
        try:
            self._popen.stdin.write(" ".join(map(str, words)) + "\n")
            self._popen.stdin.flush()
        except BrokenPipeError:
            raise BenchmarkError(f"{self.name} has ended") from None

    def answer(self, timeout_s: float = _ANSWER_S) -> Any:
        """Return the next answer of an actor."""
        return json.loads(self._line(time.monotonic() + timeout_s))

    def ask(self, *words: object, timeout_s: float = _ANSWER_S) -> Any:
        """Give an actor an order and return its answer."""
        self.send(*words)
        return self.answer(timeout_s)

    def line_with(self, pattern: str, timeout_s: float = _ANSWER_S) -> str:
        """Return the first match in the output of the process."""
        deadline_s = time.monotonic() + timeout_s
        while True:
            if found := re.search(pattern, self._line(deadline_s)):
                return found[0]

    def is_running(self) -> bool:
        """Return whether it is still running."""
        return self._popen.poll() is None

    def end(self) -> None:
        """End it and its group: by the end of its stdin or by SIGINT, and in the end by force."""
        if self._popen.stdin is not None:
            with contextlib.suppress(BrokenPipeError):
                self._popen.stdin.close()
        else:
            self._signal(signal.SIGINT)
        try:
            self._popen.wait(_END_S)
        except subprocess.TimeoutExpired:
            print(f"{self.name} does not end, killing it", file=sys.stderr)
        finally:
            self._signal(signal.SIGKILL)  # also its remaining children
            self._popen.wait()
        self._reader.join(_END_S)

    def _signal(self, number: int) -> None:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.pid, number)

    def _line(self, deadline_s: float) -> str:
        try:
            line = self._lines.get(timeout=max(0.0, deadline_s - time.monotonic()))
        except queue.Empty:
            raise BenchmarkError(f"{self.name} does not answer in time") from None
        if line is None:
            self._lines.put(None)
            raise BenchmarkError(f"{self.name} has ended unexpectedly")
        return line

    def _read(self) -> None:
        assert self._popen.stdout is not None
        with self._popen.stdout as lines:
            for line in lines:
                self._lines.put(line)
        self._lines.put(None)


@contextlib.contextmanager
def running(name: str, *command: str, is_asked: bool = False) -> Iterator[Process]:
    """Run a command, and end it in any case."""
    try:
        process = Process(name, list(command), is_asked=is_asked)
    except OSError as error:
        raise BenchmarkError(f"cannot start {command[0]}: {error.strerror}") from None
    try:
        yield process
    finally:
        process.end()


@contextlib.contextmanager
def acting(name: str, *arguments: object, before: tuple[str, ...] = ()) -> Iterator[Process]:
    """Run a program of `benchmarks.actors`, whose first answer is still to be read.

    *before* is a command that runs it, such as one that enters a network.
    """
    command = [sys.executable, "-m", f"benchmarks.actors.{name}", *map(str, arguments)]
    with running(name, *before, *command, is_asked=True) as actor:
        yield actor


def wait_until(condition: Callable[[], bool], what: str, timeout_s: float = _ANSWER_S) -> None:
    """Poll until the condition holds."""
    deadline_s = time.monotonic() + timeout_s
    while not condition():
        if time.monotonic() > deadline_s:
            raise BenchmarkError(f"not within {timeout_s:g} s: {what}")
        time.sleep(0.05)


def cpu_s(pid: int) -> float:
    """Return the user and system time that a process and its children have used.

    A child that has ended counts once its parent has waited for it.
    """
    return sum(_cpu_s(one) for one in _family(pid))


def memory_mb(pid: int) -> float:
    """Return the resident memory of a process and its children."""
    pages = sum(int(_read(one, "statm", "0 0").split()[1]) for one in _family(pid))
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def _family(pid: int) -> list[int]:
    parents: dict[int, int] = {}
    for path in Path("/proc").glob("[0-9]*"):
        fields = _stat(int(path.name))
        if fields:
            parents[int(path.name)] = int(fields[1])
    family = [pid]
    for one in family:  # grows during the loop
        family += [child for child, parent in parents.items() if parent == one]
    return family


def _cpu_s(pid: int) -> float:
    """Return the time of one process by its clock, in nanoseconds. ``/proc`` has only 10 ms.

    Its ended children have no such clock.
    """
    clock = ctypes.c_int()
    if _LIBC.clock_getcpuclockid(pid, ctypes.byref(clock)) != 0:
        return 0.0  # it has just ended
    with contextlib.suppress(OSError):
        children_ticks = sum(map(int, _stat(pid)[13:15]))  # cutime, cstime: see proc(5)
        return time.clock_gettime(clock.value) + children_ticks / _TICKS_PER_S
    return 0.0


def _stat(pid: int) -> list[str]:
    """Return the fields after the name, none of a process that has just ended."""
    return _read(pid, "stat", ")").rsplit(")", 1)[1].split()


def _read(pid: int, name: str, otherwise: str) -> str:
    try:
        return Path(f"/proc/{pid}/{name}").read_text()
    except (FileNotFoundError, ProcessLookupError):
        return otherwise
