# SPDX-License-Identifier: Apache-2.0
"""Long work on the event loop, a slice in each of its turns, so that all others have theirs.

A thread would make them wait for longer: it also holds the GIL for each slice, and getting
it back takes up to 5 ms (`sys.getswitchinterval`).
"""

import asyncio
import time
from collections import deque
from collections.abc import Callable
from typing import Final, Protocol

# Of a turn of the event loop, a little more than one delivery of many samples takes. Each other
# client waits for so long at most.
TURN_NS: Final = 500_000
# Each holds a message three times as large as its sample. One alone would make a cloud wait until
# a map is done.
MAX_JOBS: Final = 4


class Job(Protocol):
    """Work in slices of much less than a turn."""

    def step(self) -> bool:
        """Do a slice. Return whether more is to be done. It does not raise."""


class Slices:
    """The jobs that are under way, one slice of each at a time. They end with their loop."""

    def __init__(self, clock_ns: Callable[[], int] = time.monotonic_ns) -> None:
        self._clock_ns = clock_ns
        self._jobs: deque[Job] = deque()
        self._waiting: dict[Callable[[], None], None] = {}
        self._turn: asyncio.Handle | None = None

    def has_room(self, on_room: Callable[[], None]) -> bool:
        """Return whether another job may begin. If not, *on_room* is called once it may."""
        if len(self._jobs) < MAX_JOBS:
            return True
        self._waiting[on_room] = None
        return False

    def begin(self, job: Job) -> None:
        """Do the first slices of a job at once, and the others in later turns."""
        end_ns = self._clock_ns() + TURN_NS
        while job.step():
            if self._clock_ns() >= end_ns:
                self._jobs.append(job)
                self._continue()
                return

    def _continue(self) -> None:
        if self._turn is None and self._jobs:
            self._turn = asyncio.get_running_loop().call_soon(self._take_turn)

    def _take_turn(self) -> None:
        self._turn = None
        jobs = self._jobs
        end_ns = self._clock_ns() + TURN_NS
        try:
            while jobs:
                job = jobs.popleft()
                if job.step():
                    jobs.append(job)
                else:
                    self._make_room()
                if self._clock_ns() >= end_ns:
                    break
        finally:  # a fault of one job is not that of the others
            self._continue()

    def _make_room(self) -> None:
        waiting, self._waiting = self._waiting, {}
        for on_room in waiting:
            on_room()
