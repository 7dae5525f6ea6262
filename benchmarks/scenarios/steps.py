# SPDX-License-Identifier: Apache-2.0
"""The cost of each step: the gateway's path from DDS to a socket, one step longer at a time.

The cost of a step is the difference to the path without it, of medians over the rounds. Steps of a
microsecond or two drown in the noise of waking up a thousand times a second.
"""

import statistics
import time
from typing import Final

from benchmarks.actors.path import steps
from benchmarks.figures import Figure
from benchmarks.plan import Plan
from benchmarks.processes import acting, cpu_s
from benchmarks.receivers import ReceivingClient, publishing
from benchmarks.samples import SAMPLES
from benchmarks.servers import MeasuredServer

_SCENARIO: Final = "steps"
_SAMPLES: Final = ("odometry", "image")
_WARM_UP_S: Final = 2.0
_GATEWAY: Final = "the gateway: routing, bounds and counters"


def measure(plan: Plan) -> list[Figure]:
    """Print tables and return the figures."""
    return [figure for name in _SAMPLES for figure in _measure(name, plan)]


def _measure(name: str, plan: Plan) -> list[Figure]:
    rate_hz = SAMPLES[name].rate_hz
    rounds: list[list[float]] = []
    with publishing(name, rate_hz):
        for _ in range(plan.rounds):
            counts = range(1, len(steps(name)) + 1)
            spent_us = [_path_us(name, count, rate_hz, plan.seconds) for count in counts]
            with ReceivingClient(MeasuredServer()).receiving(name) as reception:
                rounds.append([*spent_us, reception.receipt(plan.seconds).cpu_us_per_message])
    print(f"{name} at {rate_hz:g} Hz, CPU us per message")
    print(f"  {'':44}{'in all':>8}{'step':>8}")
    figures: list[Figure] = []
    before_us = 0.0
    for step, spent in zip((*steps(name), _GATEWAY), zip(*rounds, strict=True), strict=True):
        in_all_us = statistics.median(spent)
        print(f"  {step:44}{in_all_us:8.0f}{in_all_us - before_us:8.0f}", flush=True)
        figures.append(Figure(_SCENARIO, f"{name}, up to {step}", in_all_us, "us per message"))
        before_us = in_all_us
    return figures


def _path_us(name: str, count: int, rate_hz: float, seconds: float) -> float:
    """Return the CPU time of *count* steps for a message. A client reads the output, if any."""
    with acting("path", name, count) as path, acting("client", path.answer(), name) as client:
        client.answer()
        time.sleep(_WARM_UP_S)
        before_s, started_s = cpu_s(path.pid), time.monotonic()
        time.sleep(seconds)
        return (cpu_s(path.pid) - before_s) / (time.monotonic() - started_s) / rate_hz * 1e6
