# SPDX-License-Identifier: Apache-2.0
"""A robot of 20 topics to 10 clients of all of them, whose pictures have five different options.

Pictures are counted by their options alone: a server may drop some, and send the newest.
"""

import contextlib
import statistics
import time
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import partial
from typing import Any, Final

from benchmarks.figures import Figure
from benchmarks.plan import Plan
from benchmarks.processes import Process, acting, cpu_s, memory_mb, wait_until
from benchmarks.robot import CAMERAS, ODOMETRY, PICTURE_OPTIONS, ROBOT
from benchmarks.servers import MeasuredServer

_SCENARIO: Final = "robot"
_CLIENTS_EACH: Final = 2  # of the clients with equal options, which may share an encoding
_CLIENTS: Final = _CLIENTS_EACH * len(PICTURE_OPTIONS)
_WARM_UP_S: Final = 4.0
_GRACE_S: Final = 1.0
_START_S: Final = 60.0  # of 10 clients with 20 subscriptions each
_MARGIN_S: Final = 30.0


@dataclass(frozen=True)
class Run:
    """The messages and the cost of one run."""

    sent: Mapping[str, int]
    """By topic."""
    seconds: float
    spent_s: float
    """The CPU time of the server."""
    memory_mb: float
    got: Mapping[str, Mapping[str, int]]
    """By options and topic, by all clients of these options."""
    ages: Mapping[str, Mapping[str, Mapping[str, Any]]]
    """By options and topic."""

    @property
    def frames_per_s(self) -> float:
        """The frames that all clients got, per second."""
        return sum(sum(one.values()) for one in self.got.values()) / self.seconds

    @property
    def delivered(self) -> float:
        """The share of all messages but pictures that arrived."""
        return self.share(self.sent.keys() - CAMERAS)

    @property
    def core_share(self) -> float:
        """The share of a core that the server used."""
        return self.spent_s / self.seconds

    def share(self, names: Collection[str], options: Collection[str] = PICTURE_OPTIONS) -> float:
        """Return the share of the messages of topics that arrived at clients with options."""
        sent = sum(number for name, number in self.sent.items() if name in names)
        got = sum(self.got[one][name] for one in options for name in names)
        return got / (sent * _CLIENTS_EACH * len(options))

    def pictures_per_s(self, options: str) -> float:
        """Return the pictures of one camera that a client with these options got, per second."""
        pictures = sum(self.got[options][name] for name in CAMERAS)
        return pictures / len(CAMERAS) / _CLIENTS_EACH / self.seconds

    def picture_ms(self, percentile: str, options: str) -> float:
        """Return an age of the pictures of clients with these options."""
        return statistics.median(_ms(self.ages[options][name], percentile) for name in CAMERAS)

    def odometry_ms(self, percentile: str) -> float:
        """Return an age of odometry, the median of the processes of clients."""
        return statistics.median(_ms(one[ODOMETRY], percentile) for one in self.ages.values())


def measure(plan: Plan) -> list[Figure]:
    """Print tables and return the figures."""
    rate_hz = sum(one.rate_hz for one in ROBOT.values())
    print(f"{len(ROBOT)} topics, {rate_hz:g} messages/s, to {_CLIENTS} clients of all of them")
    print(f"  {'':16}{'frames/s':>10}{'delivered %':>13}{'% of a core':>13}{'MB':>6}", end="")
    print(f"{'odometry, p50 ms':>18}{'p99 ms':>8}{'pictures, p50 ms':>18}{'p99 ms':>8}")
    figures: list[Figure] = []
    for server in plan.servers:
        measured = runs(server, plan)
        figures += _totals(server.name, measured)
        figures += _pictures(server.name, measured)
    return figures


def runs(server: MeasuredServer, plan: Plan) -> list[Run]:
    """Run a robot, the server, and its clients, and count in each round."""
    with scene(server.running()) as (_, run):
        return [run(plan.seconds) for _ in range(plan.rounds)]


@contextlib.contextmanager
def scene(
    server: AbstractContextManager[tuple[str, Process]],
) -> Iterator[tuple[str, Callable[[float], Run]]]:
    """Start a robot, a server, and its clients. Yield the URL, and what counts for some seconds."""
    with contextlib.ExitStack() as stack:
        robot = [stack.enter_context(_publishing(names)) for names in _nodes()]
        url, process = stack.enter_context(server)
        clients = {
            options: stack.enter_context(acting("robot_clients", url, options, _CLIENTS_EACH))
            for options in PICTURE_OPTIONS
        }
        for client in clients.values():
            client.answer(_START_S)
        _run(robot, process, clients, _WARM_UP_S)
        wait_until(
            lambda: all(one.ask("complete") == _CLIENTS_EACH for one in clients.values()),
            f"{_CLIENTS} clients get all topics",
        )
        yield url, partial(_run, robot, process, clients)


def _nodes() -> tuple[list[str], list[str]]:
    """Return the topics of two processes: publishing a picture must not delay the rest."""
    return [name for name in ROBOT if name not in CAMERAS], list(CAMERAS)


@contextlib.contextmanager
def _publishing(names: Sequence[str]) -> Iterator[Process]:
    with acting("robot", *names) as publisher:
        publisher.answer()
        yield publisher


def _run(
    robot: Sequence[Process], server: Process, clients: Mapping[str, Process], seconds: float
) -> Run:
    for client in clients.values():
        client.ask("clear")
    before_s = cpu_s(server.pid)
    for one in robot:
        one.send("run", seconds)
    answers = [one.answer(_MARGIN_S + 10 * seconds) for one in robot]
    got = _settled(clients)
    return Run(
        {name: number for one in answers for name, number in one["sent"].items()},
        max(one["seconds"] for one in answers),
        cpu_s(server.pid) - before_s,
        memory_mb(server.pid),
        got,
        {options: client.ask("report") for options, client in clients.items()},
    )


def _settled(clients: Mapping[str, Process]) -> dict[str, dict[str, int]]:
    """Return the messages that all got once no more arrive: on a busy machine some are late."""
    before: dict[str, dict[str, int]] = {}
    while (got := {options: one.ask("count") for options, one in clients.items()}) != before:
        before = got
        time.sleep(_GRACE_S)
    return got


def _ms(summary: Mapping[str, Any], percentile: str) -> float:
    return float(summary.get(f"{percentile}_ms", float("nan")))


def _totals(who: str, measured: Sequence[Run]) -> list[Figure]:
    """Print the row of a server."""

    def median(name: str, values: Iterator[float], unit: str) -> Figure:
        return Figure(_SCENARIO, f"{who}, {name}", statistics.median(values), unit)

    figures = [
        median("frames", (one.frames_per_s for one in measured), "frames/s"),
        median("delivered", (one.delivered * 100 for one in measured), "%"),
        median("of a core", (one.core_share * 100 for one in measured), "%"),
        median("memory", (one.memory_mb for one in measured), "MB"),
        median("odometry p50", (one.odometry_ms("p50") for one in measured), "ms"),
        median("odometry p99", (one.odometry_ms("p99") for one in measured), "ms"),
        *(
            median(
                f"pictures {percentile}",
                (one.picture_ms(percentile, name) for one in measured for name in PICTURE_OPTIONS),
                "ms",
            )
            for percentile in ("p50", "p99")
        ),
    ]
    frames, delivered, share, memory, *ages = (one.value for one in figures)
    print(f"  {who:16}{frames:10.0f}{delivered:13.2f}{share:13.1f}{memory:6.0f}", end="")
    print("".join(f"{p50:18.1f}{p99:8.1f}" for p50, p99 in (ages[:2], ages[2:])), flush=True)
    return figures


def _pictures(who: str, measured: Sequence[Run]) -> list[Figure]:
    """Print the pictures of a server by the clients' options."""
    figures: list[Figure] = []
    print(f"    {'pictures with':20}{'a second':>10}{'p50 ms':>8}{'p99 ms':>8}")
    for options in PICTURE_OPTIONS:
        rate_hz = statistics.median(one.pictures_per_s(options) for one in measured)
        p50_ms = statistics.median(one.picture_ms("p50", options) for one in measured)
        p99_ms = statistics.median(one.picture_ms("p99", options) for one in measured)
        print(f"    {options:20}{rate_hz:10.1f}{p50_ms:8.1f}{p99_ms:8.1f}", flush=True)
        case = f"{who}, pictures with {options}"
        figures.append(Figure(_SCENARIO, f"{case}, rate", rate_hz, "Hz"))
        figures.append(Figure(_SCENARIO, f"{case}, p50", p50_ms, "ms"))
        figures.append(Figure(_SCENARIO, f"{case}, p99", p99_ms, "ms"))
    return figures
