# SPDX-License-Identifier: Apache-2.0
"""Receivers of a sample, and their cost: a bare rclpy subscriber, or a server with a client."""

import contextlib
import time
from collections.abc import Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Any, Protocol

from benchmarks.errors import BenchmarkError
from benchmarks.processes import Process, acting, cpu_s, memory_mb, wait_until
from benchmarks.servers import MeasuredServer

_WARM_UP_S = 2.0  # discovery, and code that is compiled at first use


@dataclass(frozen=True)
class Receipt:
    """The messages of one receiver, and the CPU time of the measured process in the meantime."""

    rate_hz: float
    p50_ms: float
    p90_ms: float
    p99_ms: float
    cpu_us_per_message: float
    memory_mb: float


@dataclass(frozen=True)
class Receiving:
    """A running receiver: the actor that records ages, and the measured process."""

    actor: Process
    tested_pid: int
    sample: str

    def count(self) -> int:
        """Return the number of messages since the last `clear`."""
        return int(self.actor.ask("count"))

    def report(self) -> dict[str, Any]:
        """Return the summary of these messages."""
        result: dict[str, Any] = self.actor.ask("report")[self.sample]
        return result

    def clear(self) -> None:
        """Forget the messages so far. Call it while none arrive."""
        self.actor.ask("clear")

    def receipt(self, seconds: float) -> Receipt:
        """Let the flow of samples continue for a while, and return its cost."""
        wait_until(lambda: self.count() > 0, f"{self.actor.name} gets a first {self.sample}")
        time.sleep(_WARM_UP_S)
        before, before_s, started_s = self.count(), cpu_s(self.tested_pid), time.monotonic()
        time.sleep(seconds)
        received, spent_s = self.count() - before, cpu_s(self.tested_pid) - before_s
        took_s = time.monotonic() - started_s
        if received == 0:
            raise BenchmarkError(f"{self.actor.name} gets no {self.sample} any more")
        seen = self.report()
        return Receipt(
            received / took_s,
            seen["p50_ms"],
            seen["p90_ms"],
            seen["p99_ms"],
            spent_s / received * 1e6,
            memory_mb(self.tested_pid),
        )


class Receiver(Protocol):
    """Something that can receive a sample."""

    @property
    def name(self) -> str:
        """The name in tables."""

    def receiving(self, sample: str) -> AbstractContextManager[Receiving]:
        """Receive until the end."""


@dataclass(frozen=True)
class Floor:
    """A bare rclpy subscriber on the standard executor."""

    name: str = "floor"

    @contextlib.contextmanager
    def receiving(self, sample: str) -> Iterator[Receiving]:
        """Receive until the end."""
        with acting("floor", sample, "plain") as actor:
            actor.answer()
            yield Receiving(actor, actor.pid, sample)


@dataclass(frozen=True)
class ReceivingClient:
    """A server with one client. The server is measured."""

    server: MeasuredServer

    @property
    def name(self) -> str:
        """The name in tables."""
        return self.server.name

    @contextlib.contextmanager
    def receiving(self, sample: str) -> Iterator[Receiving]:
        """Receive until the end."""
        with self.server.running() as (url, process), acting("client", url, sample) as actor:
            actor.answer()
            yield Receiving(actor, process.pid, sample)


@contextlib.contextmanager
def publishing(
    sample: str,
    rate_hz: float = 0.0,
    *,
    topics: int = 1,
    share: str = "0/1",
    before: tuple[str, ...] = (),
) -> Iterator[Process]:
    """Publish at a rate until the end, or as ordered if the rate is 0."""
    with acting("publisher", sample, topics, share, "now", before=before) as publisher:
        publisher.answer()
        if rate_hz:
            publisher.ask("go", rate_hz)
        yield publisher
