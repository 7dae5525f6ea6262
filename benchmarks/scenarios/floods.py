# SPDX-License-Identifier: Apache-2.0
"""The fate of a driver and of a stop next to eight clients that flood within all limits."""

import contextlib
import itertools
import statistics
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Final

from benchmarks.actors.flooder import KINDS
from benchmarks.figures import Figure
from benchmarks.plan import Plan
from benchmarks.processes import Process, acting, wait_until
from benchmarks.servers import MeasuredServer

_SCENARIO: Final = "floods"
_CLIENTS: Final = 8
_STOPS: Final = 30
_CALM: Final = "none"


@dataclass(frozen=True)
class Drive:
    """The service that a driver and a stop had under a flood."""

    stops_ms: list[float]
    through: float
    """The share of the commands that the robot heard."""
    gap_ms: float
    """The longest time between two of them."""
    refusals: list[str]


def measure(plan: Plan) -> list[Figure]:
    """Print a table and return the figures."""
    print(f"a driver at 20 Hz, and {_STOPS} stops, next to {_CLIENTS} clients that flood")
    print(f"  {'':16}{'':15}{'stop ms':>9}{'most':>7}{'through':>9}{'gap ms':>8}  refused")
    return [
        figure
        for server in plan.servers
        for kind in (_CALM, *KINDS)
        for figure in _figures(server.name, kind, _beside(server, kind, plan.seconds))
    ]


def _beside(server: MeasuredServer, kind: str, seconds: float) -> Drive:
    with (
        acting("base") as base,
        server.running() as (url, _),
        acting("driver", url) as driver,
    ):
        base.answer()
        driver.answer()
        wait_until(lambda: _moves(base, driver), "the robot moves")
        with _flood(url, kind):
            driver.ask("drive", 1)  # until the first burst of each client is spent
            base.ask("clear")
            drive = driver.ask("drive", seconds)
            heard = base.ask("report")
            stops_ms = driver.ask("stop", _STOPS)
    speeds = {round(speed, 6) for speed in drive["speeds"]}
    times = [time_s for time_s, speed in heard if round(speed, 6) in speeds]
    through = len({round(speed, 6) for _, speed in heard} & speeds) / len(speeds)
    gap_ms = max((b - a for a, b in itertools.pairwise(times)), default=float("inf")) * 1e3
    return Drive(stops_ms, through, gap_ms, drive["refusals"])


def _moves(base: Process, driver: Process) -> bool:
    driver.ask("drive", 0.5)
    return any(speed for _, speed in base.ask("report"))


@contextlib.contextmanager
def _flood(url: str, kind: str) -> Iterator[Any]:
    if kind == _CALM:
        yield
        return
    with acting("flooder", url, kind, _CLIENTS) as flooder:
        flooder.answer()
        yield


def _figures(who: str, kind: str, drive: Drive) -> list[Figure]:
    median_ms, most_ms = statistics.median(drive.stops_ms), max(drive.stops_ms)
    print(
        f"  {who:16}{kind:15}{median_ms:9.1f}{most_ms:7.1f}{drive.through:9.0%}"
        f"{drive.gap_ms:8.0f}  {', '.join(drive.refusals)}",
        flush=True,
    )
    return [
        Figure(_SCENARIO, f"{who}, {kind}, stop", median_ms, "ms"),
        Figure(_SCENARIO, f"{who}, {kind}, slowest stop", most_ms, "ms"),
        Figure(_SCENARIO, f"{who}, {kind}, commands that went through", drive.through),
        Figure(_SCENARIO, f"{who}, {kind}, longest gap", drive.gap_ms, "ms"),
    ]
