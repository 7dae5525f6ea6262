# SPDX-License-Identifier: Apache-2.0
"""The growth of cost: it should grow with the delivered frames, and with nothing else."""

import contextlib
import statistics
import time
from typing import Final

from benchmarks.crowds import Load, crowd_of, load
from benchmarks.figures import Figure, ratio
from benchmarks.plan import Plan
from benchmarks.processes import Process, cpu_s, wait_until
from benchmarks.receivers import publishing
from benchmarks.servers import MeasuredServer

_SCENARIO: Final = "growth"
_SAMPLE: Final = "odometry"
_RATES_HZ: Final = (250.0, 500.0, 1000.0, 2000.0)
_CLIENTS: Final = (1, 10, 50)
_CLIENTS_HZ: Final = 50.0
_BYSTANDERS: Final = 200  # topics that nobody subscribes to
_STEADY_HZ: Final = 500.0
_LATER_S: Final = 120.0
_ROOM: Final = {"max_clients": max(_CLIENTS), "max_clients_per_address": max(_CLIENTS)}

_Working = tuple[Process, Process]
"""A server, and the crowd that it serves."""


def measure(plan: Plan) -> list[Figure]:
    """Print tables and return the figures."""
    print(f"{_SAMPLE}: how cost grows")
    print(f"  {'':16}{'':28}{'frames/s':>9}{'CPU us per frame':>18}{'% of a core':>13}")
    figures: list[Figure] = []
    for server in plan.servers:
        figures += _by_rate(server, plan.seconds)
        figures += _by_clients(server, plan.seconds)
        figures += _by_bystanders(server, plan)
        figures += _by_uptime(server, plan)
    return figures


def _by_rate(server: MeasuredServer, seconds: float) -> list[Figure]:
    loads = [_load(server, f"{rate:.0f} Hz", rate, 1, seconds) for rate in _RATES_HZ]
    slope, fixed = statistics.linear_regression(
        [one.frames_per_s for one in loads], [one.core_share for one in loads]
    )
    print(f"  {server.name:16}{fixed * 100:.2f} % of a core, and {slope * 1e6:.0f} us per message")
    return [
        Figure(_SCENARIO, f"{server.name}, fixed", fixed * 100, "% of a core"),
        Figure(_SCENARIO, f"{server.name}, each message", slope * 1e6, "us"),
        *(
            _us_per_frame(server, f"{rate:.0f} Hz", one)
            for rate, one in zip(_RATES_HZ, loads, strict=True)
        ),
    ]


def _by_clients(server: MeasuredServer, seconds: float) -> list[Figure]:
    return [
        _us_per_frame(server, case, _load(server, case, _CLIENTS_HZ, clients, seconds))
        for clients in _CLIENTS
        for case in [f"{clients} clients, {_CLIENTS_HZ:.0f} Hz"]
    ]


def _by_bystanders(server: MeasuredServer, plan: Plan) -> list[Figure]:
    """Measure in turns: the expected difference of 0 is smaller than a machine's drift."""
    rounds = []
    for _ in range(plan.rounds):
        without = _load(server, "0 idle topics beside", _STEADY_HZ, 1, plan.seconds)
        with publishing("twist", topics=_BYSTANDERS):
            case = f"{_BYSTANDERS} idle topics beside"
            rounds.append((without, _load(server, case, _STEADY_HZ, 1, plan.seconds)))
    beside = statistics.median(many.us_per_frame / none.us_per_frame for none, many in rounds)
    print(f"  {server.name:16}{beside:.2f} times the cost with {_BYSTANDERS} idle topics")
    return [ratio(_SCENARIO, f"{server.name}, CPU with idle topics beside that without", beside)]


def _by_uptime(server: MeasuredServer, plan: Plan) -> list[Figure]:
    """Measure a server that has been busy for a while next to one that has just been started.

    Both run at once, as minutes later the machine's speed may differ. A server with a fixed port
    cannot run twice.
    """
    if server.command:
        return []
    with contextlib.ExitStack() as stack:
        stack.enter_context(publishing(_SAMPLE, _STEADY_HZ))
        url, old = stack.enter_context(server.running())
        old_crowd = stack.enter_context(crowd_of(url, _SAMPLE, 1))
        time.sleep(_LATER_S)
        url, fresh = stack.enter_context(server.running())
        fresh_crowd = stack.enter_context(crowd_of(url, _SAMPLE, 1))
        wait_until(lambda: fresh_crowd.ask("count") > _STEADY_HZ, "the fresh one has warmed up")
        beside = statistics.median(
            _beside((old, old_crowd), (fresh, fresh_crowd), plan.seconds)
            for _ in range(plan.rounds)
        )
    print(f"  {server.name:16}{beside:.2f} of a fresh one's cost after {_LATER_S:.0f} s")
    return [ratio(_SCENARIO, f"{server.name}, CPU after a while beside a fresh one's", beside)]


def _beside(one: _Working, other: _Working, seconds: float) -> float:
    """Return the CPU time per frame of one server as a multiple of the other's, both busy."""
    before = [(crowd.ask("count"), cpu_s(server.pid)) for server, crowd in (one, other)]
    time.sleep(seconds)
    after = [(crowd.ask("count"), cpu_s(server.pid)) for server, crowd in (one, other)]
    costs: list[float] = [
        (spent - spent_before) / (count - count_before)
        for (count, spent), (count_before, spent_before) in zip(after, before, strict=True)
    ]
    return costs[0] / costs[1]


def _load(server: MeasuredServer, case: str, rate_hz: float, clients: int, seconds: float) -> Load:
    with (
        publishing(_SAMPLE, rate_hz),
        server.running(_ROOM) as (url, process),
        crowd_of(url, _SAMPLE, clients) as crowd,
    ):
        result = load(crowd, process, clients, seconds)
    _print_row(server.name, case, result)
    return result


def _print_row(name: str, case: str, one: Load) -> None:
    print(
        f"  {name:16}{case:28}{one.frames_per_s:9.0f}{one.us_per_frame:18.1f}"
        f"{one.core_share * 100:13.1f}",
        flush=True,
    )


def _us_per_frame(server: MeasuredServer, case: str, one: Load) -> Figure:
    return Figure(_SCENARIO, f"{server.name}, {case}", one.us_per_frame, "us per frame")
