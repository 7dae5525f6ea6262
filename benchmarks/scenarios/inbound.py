# SPDX-License-Identifier: Apache-2.0
"""Twists into ROS: a client publishes, a bare rclpy process receives them.

The floor is a bare rclpy subscriber that receives Twists at the same rate from ROS. This is
the least that a Python process spends to move such a message between DDS and Python.
"""

import contextlib
import statistics
from collections.abc import Iterator
from typing import Final

from benchmarks.figures import Figure, ratio
from benchmarks.plan import Plan
from benchmarks.processes import Process, acting
from benchmarks.receivers import Floor, Receipt, Receiving, publishing
from benchmarks.scenarios.held_rate import search, senders
from benchmarks.search import Highest
from benchmarks.servers import NO_INBOUND_LIMITS, MeasuredServer

_SCENARIO: Final = "inbound"
_SAMPLE: Final = "twist"
_RATE_HZ: Final = 1000.0


def measure(plan: Plan) -> list[Figure]:
    """Print a table and return the figures."""
    print(f"{_SAMPLE} at {_RATE_HZ:g} Hz from a client into ROS")
    print(f"  {'':16}{'Hz':>6}{'CPU us':>9}{'ratio':>7}{'p50 ms':>8}{'p99 ms':>8}{'held/s':>10}")
    rounds: list[list[Receipt]] = []
    for _ in range(plan.rounds):
        floor = _floor(plan.seconds)
        rounds.append([floor, *(_inbound(one, plan.seconds) for one in plan.servers)])
    floor_us = statistics.median(one[0].cpu_us_per_message for one in rounds)
    print(f"  {'floor, receiving':22}{floor_us:9.0f}")
    figures: list[Figure] = []
    for column, server in enumerate(plan.servers, start=1):
        held = _highest(server, plan.seconds) if plan.seeks_highest_rates else None
        figures += _figures(server.name, [(one[0], one[column]) for one in rounds], held)
    return figures


def _floor(seconds: float) -> Receipt:
    with publishing(_SAMPLE, _RATE_HZ), Floor().receiving(_SAMPLE) as reception:
        return reception.receipt(seconds)


def _inbound(server: MeasuredServer, seconds: float) -> Receipt:
    with (
        _heard(server) as (url, reception),
        _speaking(url) as speaker,
    ):
        speaker.ask("go", _RATE_HZ)
        return reception.receipt(seconds)


def _highest(server: MeasuredServer, seconds: float) -> Highest:
    with _heard(server) as (url, reception), senders(lambda share: _speaking(url, share)) as all_:
        return search(all_, reception, _RATE_HZ, seconds)


@contextlib.contextmanager
def _heard(server: MeasuredServer) -> Iterator[tuple[str, Receiving]]:
    with (
        server.running(NO_INBOUND_LIMITS) as (url, process),
        acting("floor", _SAMPLE, "raw") as listener,
    ):
        listener.answer()
        yield url, Receiving(listener, process.pid, _SAMPLE)


@contextlib.contextmanager
def _speaking(url: str, share: str = "0/1") -> Iterator[Process]:
    with acting("speaker", url, share) as speaker:
        speaker.answer()
        yield speaker


def _figures(name: str, pairs: list[tuple[Receipt, Receipt]], held: Highest | None) -> list[Figure]:
    cpu_us = statistics.median(one.cpu_us_per_message for _, one in pairs)
    beside = statistics.median(a.cpu_us_per_message / b.cpu_us_per_message for b, a in pairs)
    p50_ms = statistics.median(one.p50_ms for _, one in pairs)
    p99_ms = statistics.median(one.p99_ms for _, one in pairs)
    rate_hz = statistics.median(one.rate_hz for _, one in pairs)
    print(
        f"  {name:16}{rate_hz:6.0f}{cpu_us:9.0f}{beside:7.2f}{p50_ms:8.2f}{p99_ms:8.2f}"
        f"{'' if held is None else str(held):>10}",
        flush=True,
    )
    figures = [
        ratio(_SCENARIO, f"{name}, CPU beside the floor's", beside),
        Figure(_SCENARIO, f"{name}, CPU", cpu_us, "us per message"),
        Figure(_SCENARIO, f"{name}, p50", p50_ms, "ms"),
        Figure(_SCENARIO, f"{name}, p99", p99_ms, "ms"),
    ]
    if held is not None:
        what = "highest rate sent, all held" if held.is_senders_limit else "highest rate held"
        figures.append(Figure(_SCENARIO, f"{name}, {what}", held.rate_hz, "Hz"))
    return figures
