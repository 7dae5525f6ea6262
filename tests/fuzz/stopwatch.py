# SPDX-License-Identifier: Apache-2.0
"""The longest that one operation has taken, in time of the CPU: other programs do not matter."""

import contextlib
import time
from collections.abc import Callable, Iterator
from typing import Final


class Stopwatch:
    """Measures what a target says is one operation, else the whole of it."""

    def __init__(self) -> None:
        self._longest_s: float | None = None

    @contextlib.contextmanager
    def running(self) -> Iterator[None]:
        """Measure one operation."""
        started_s = time.thread_time()
        yield
        self._longest_s = max(self._longest_s or 0.0, time.thread_time() - started_s)

    def longest_s(self, work: Callable[[], object]) -> float:
        """Do *work*. Return the time of its longest operation."""
        self._longest_s = None
        started_s = time.thread_time()
        work()
        whole_s = time.thread_time() - started_s
        return whole_s if self._longest_s is None else self._longest_s


STOPWATCH: Final = Stopwatch()
