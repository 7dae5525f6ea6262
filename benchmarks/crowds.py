# SPDX-License-Identifier: Apache-2.0
"""The cost of many clients to a server, while samples flow."""

import contextlib
import time
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from benchmarks.processes import Process, acting, cpu_s, memory_mb, wait_until

_WARM_UP_S: Final = 1.0


@dataclass(frozen=True)
class Load:
    """The frames delivered, and the CPU time that the server used in the meantime."""

    seconds: float
    frames: int
    spent_s: float
    memory_mb: float

    @property
    def frames_per_s(self) -> float:
        """The frames that all clients got, per second."""
        return self.frames / self.seconds

    @property
    def core_share(self) -> float:
        """The share of a core that the server used."""
        return self.spent_s / self.seconds

    @property
    def us_per_frame(self) -> float:
        """The CPU time of the server for each frame."""
        return self.spent_s / self.frames * 1e6


@contextlib.contextmanager
def crowd_of(url: str, sample: str, clients: int, topics: int = 1) -> Iterator[Process]:
    """Have clients subscribe to each of the topics of a sample."""
    with acting("crowd", url, sample, clients, topics) as crowd:
        crowd.answer()
        yield crowd


def load(crowd: Process, server: Process, clients: int, seconds: float) -> Load:
    """Measure once all clients get frames."""
    wait_until(lambda: crowd.ask("clients") == clients, f"{clients} clients get frames")
    time.sleep(_WARM_UP_S)
    before, before_s, started_s = crowd.ask("count"), cpu_s(server.pid), time.monotonic()
    time.sleep(seconds)
    frames, spent_s = crowd.ask("count") - before, cpu_s(server.pid) - before_s
    return Load(time.monotonic() - started_s, frames, spent_s, memory_mb(server.pid))
