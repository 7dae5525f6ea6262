# SPDX-License-Identifier: Apache-2.0
"""The gateway next to a server of foxglove-sdk, fed by a raw subscription: both serve CDR.

Both receive from the same publisher, in turns. The gateway also serves Odometry as JSON.
"""

import contextlib
import importlib.util
import os
import statistics
import time
from collections.abc import Iterator
from dataclasses import astuple, dataclass
from typing import Final

from benchmarks.actors.peer_clients import FOXGLOVE
from benchmarks.errors import BenchmarkError
from benchmarks.figures import Figure, ratio
from benchmarks.plan import Plan
from benchmarks.processes import Process, acting, cpu_s, wait_until
from benchmarks.receivers import publishing
from benchmarks.servers import MeasuredServer

_SCENARIO: Final = "peers"
_CLIENTS: Final = (1, 10, 100, 200)
_RATES_HZ: Final = {"odometry": 1000.0, "compressed-image": 30.0, "point-cloud": 30.0}
_RAW: Final = "cbor-raw"
_JSON: Final = "none"
_ROOM: Final = {"max_clients": max(_CLIENTS), "max_clients_per_address": max(_CLIENTS)}
_WARM_UP_S: Final = 2.0
_START_S: Final = 60.0  # 200 clients of a server that has no time left


@dataclass(frozen=True)
class Service:
    """The work of a server for all its clients, and what they have got."""

    cpu_us: float
    """For each frame that was delivered."""
    p50_ms: float
    p99_ms: float
    delivered: float
    """The share of all frames."""


def measure(plan: Plan) -> list[Figure]:
    """Print a table and return the figures.

    Raises:
        BenchmarkError: foxglove-sdk is not installed.
    """
    if importlib.util.find_spec("foxglove") is None:
        raise BenchmarkError(
            "foxglove-sdk is not installed: run .venv/bin/pip install --group peers"
        )
    print(f"load of the machine: {os.getloadavg()[0]:.1f}. All ratios are to {FOXGLOVE}'s CDR")
    print(f"  {'':17}{'clients':>8} {'':10}{'CPU us':>8}{'ratio':>7}{'p50 ms':>8}", end="")
    print(f"{'p99 ms':>8}{'delivered %':>13}")
    return [
        figure
        for name in _RATES_HZ
        for clients in _CLIENTS
        for figure in _measure(name, clients, plan)
    ]


def _measure(name: str, clients: int, plan: Plan) -> list[Figure]:
    forms = (FOXGLOVE, _RAW, *([_JSON] if name == "odometry" else []))
    with publishing(name, _RATES_HZ[name]) as publisher:
        rounds = [
            [_service(publisher, name, form, clients, plan.seconds) for form in forms]
            for _ in range(plan.rounds)
        ]
    figures = []
    for column, form in enumerate(forms):
        service = _median([one[column] for one in rounds])
        beside = statistics.median(one[column].cpu_us / one[0].cpu_us for one in rounds)
        who = "JSON" if form == _JSON else form
        print(
            f"  {name:17}{clients:8} {who:10}{service.cpu_us:8.1f}{beside:7.2f}"
            f"{service.p50_ms:8.2f}{service.p99_ms:8.2f}{service.delivered * 100:13.1f}",
            flush=True,
        )
        case = f"{name} to {clients}, {who}"
        figures += [
            Figure(_SCENARIO, f"{case}, CPU", service.cpu_us, "us per frame"),
            Figure(_SCENARIO, f"{case}, p50", service.p50_ms, "ms"),
            Figure(_SCENARIO, f"{case}, p99", service.p99_ms, "ms"),
            Figure(_SCENARIO, f"{case}, delivered", service.delivered * 100, "%"),
        ]
        if column:
            figures.append(ratio(_SCENARIO, f"{case}, CPU beside {FOXGLOVE}'s", beside))
    return figures


def _service(publisher: Process, name: str, form: str, clients: int, seconds: float) -> Service:
    with (
        _serving(name, form) as (url, server),
        acting("peer_clients", url, name, form, clients) as crowd,
    ):
        crowd.answer(_START_S)
        wait_until(
            lambda: crowd.ask("served") == clients, f"{clients} clients get {name}", _START_S
        )
        time.sleep(_WARM_UP_S)
        crowd.ask("clear")
        frames, sent, spent_s = crowd.ask("count"), publisher.ask("count"), cpu_s(server.pid)
        time.sleep(seconds)
        frames, sent = crowd.ask("count") - frames, publisher.ask("count") - sent
        spent_s = cpu_s(server.pid) - spent_s
        ages = crowd.ask("report")
    if not frames or "p99_ms" not in ages:
        raise BenchmarkError(f"{clients} clients get no {name} as {form} any more")
    delivered = frames / (sent * clients)
    return Service(spent_s / frames * 1e6, ages["p50_ms"], ages["p99_ms"], delivered)


@contextlib.contextmanager
def _serving(name: str, form: str) -> Iterator[tuple[str, Process]]:
    if form != FOXGLOVE:
        with MeasuredServer().running(_ROOM) as running:
            yield running
        return
    with acting("foxglove_server", name) as server:
        yield server.answer(), server


def _median(services: list[Service]) -> Service:
    return Service(*map(statistics.median, zip(*map(astuple, services), strict=True)))
