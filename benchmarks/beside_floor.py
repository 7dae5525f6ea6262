# SPDX-License-Identifier: Apache-2.0
"""The gateway beside a bare rclpy subscriber: both receive from the same publisher, in turns."""

import statistics
from collections.abc import Iterable
from dataclasses import asdict, dataclass, fields
from typing import Any

from benchmarks.processes import Receipt, line_with, receive, running
from benchmarks.samples import SAMPLES


@dataclass(frozen=True)
class Comparison:
    """Medians of both, over the rounds."""

    name: str
    rate_hz: float
    floor: Receipt
    gateway: Receipt

    @property
    def cpu_ratio(self) -> float:
        """How many times the floor's CPU time the gateway takes for a message."""
        return self.gateway.cpu_us_per_message / self.floor.cpu_us_per_message

    def as_json(self) -> dict[str, Any]:
        """Return all figures."""
        return asdict(self) | {"cpu_ratio": self.cpu_ratio}


def compare(name: str, rounds: int, seconds: float) -> Comparison:
    """Measure one kind of message."""
    sample = SAMPLES[name]
    floors: list[Receipt] = []
    gateways: list[Receipt] = []
    with running("benchmarks.publisher", name, str(sample.rate_hz)):
        for _ in range(rounds):
            floors.append(_floor(name, seconds))
            gateways.append(_gateway(name, seconds))
    return Comparison(name, sample.rate_hz, _median(floors), _median(gateways))


def table(comparisons: Iterable[Comparison]) -> str:
    """Return all in one table: of each pair of columns the first is the floor's."""
    head = f"{'':18}{'Hz':>6}{'CPU us per message':>22}{'ratio':>7}"
    head += f"{'p50 ms':>14}{'p90 ms':>14}{'p99 ms':>14}{'MB':>12}"
    lines = [head]
    for one in comparisons:
        floor, gateway = one.floor, one.gateway
        line = f"{one.name:18}{gateway.rate_hz:6.0f}"
        line += f"{floor.cpu_us_per_message:11.0f}{gateway.cpu_us_per_message:11.0f}"
        line += f"{one.cpu_ratio:7.2f}"
        for percentile in ("p50_ms", "p90_ms", "p99_ms"):
            line += f"{getattr(floor, percentile):7.2f}{getattr(gateway, percentile):7.2f}"
        line += f"{floor.memory_mb:6.0f}{gateway.memory_mb:6.0f}"
        lines.append(line)
    return "\n".join(lines)


def _floor(name: str, seconds: float) -> Receipt:
    with running("benchmarks.floor", name) as process:
        return receive(process, process.pid, seconds)


def _gateway(name: str, seconds: float) -> Receipt:
    with running("gateway", "serve", "--port", "0", "--log-level", "warning") as gateway:
        url = line_with(gateway, r"ws://\S+")
        with running("benchmarks.client", url, name) as client:
            return receive(client, gateway.pid, seconds)


def _median(receipts: list[Receipt]) -> Receipt:
    figures = [field.name for field in fields(Receipt)]
    return Receipt(*(statistics.median(getattr(one, name) for one in receipts) for name in figures))
