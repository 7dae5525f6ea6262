# SPDX-License-Identifier: Apache-2.0
"""Bursts: messages that a reliable publisher of depth 1000 sends back to back, to one client."""

import statistics
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from benchmarks.figures import Figure
from benchmarks.plan import Plan
from benchmarks.processes import Process, acting, wait_until
from benchmarks.receivers import publishing
from benchmarks.servers import MeasuredServer

_SCENARIO: Final = "bursts"
_SIZES: Final = {"string": 500, "odometry": 500, "laser-scan": 100}
_BURSTS_A_ROUND: Final = 3
_AT_ONCE_HZ: Final = 1e9  # no pause between two messages
_CALM_S: Final = 0.5  # without a further message


@dataclass(frozen=True)
class Burst:
    """The messages of one burst."""

    arrived: int
    reported: int | None
    """The number reported as lost, ``None`` for a server that reports nothing."""
    took_ms: float
    """From the first sending to the last arrival."""
    sending_ms: float
    """From the first sending to the last."""


def measure(plan: Plan) -> list[Figure]:
    """Print a table and return the figures."""
    number = _BURSTS_A_ROUND * plan.rounds
    print(f"messages back to back to one client, medians of {number} bursts")
    print(f"  {'':16}{'':14}{'sent':>6}{'arrived':>9}{'least':>8}", end="")
    print(f"{'reported lost':>15}{'in silence':>12}{'sending ms':>12}{'all ms':>8}")
    return [
        figure
        for server in plan.servers
        for name, size in _SIZES.items()
        for figure in _figures(server.name, name, size, _bursts(server, name, size, plan.rounds))
    ]


def _bursts(server: MeasuredServer, name: str, size: int, rounds: int) -> list[Burst]:
    with (
        publishing(name) as publisher,
        server.running() as (url, _),
        acting("burst_client", url, name) as client,
    ):
        client.answer()
        wait_until(lambda: publisher.ask("matched") > 0, f"{name} is subscribed to")
        publisher.ask("run", _AT_ONCE_HZ, 1)
        wait_until(lambda: client.ask("count") > 0, f"a client gets a first {name}")
        _settle(client)
        return [_burst(publisher, client, size) for _ in range(_BURSTS_A_ROUND * rounds)]


def _burst(publisher: Process, client: Process, size: int) -> Burst:
    client.ask("clear")
    sending_s = publisher.ask("run", _AT_ONCE_HZ, size)["seconds"]
    _settle(client)
    seen = client.ask("burst")
    took_ms = float("nan") if seen["took_ms"] is None else seen["took_ms"]
    return Burst(seen["distinct"], seen["reported"], took_ms, sending_s * 1e3)


def _settle(client: Process) -> None:
    """Wait until no further message arrives."""
    before, count = -1, client.ask("count")
    while count != before:
        time.sleep(_CALM_S)
        before, count = count, client.ask("count")


def _figures(who: str, name: str, size: int, bursts: Sequence[Burst]) -> list[Figure]:
    arrived = statistics.median(one.arrived for one in bursts)
    least = min(one.arrived for one in bursts)
    took_ms = statistics.median(one.took_ms for one in bursts)
    sending_ms = statistics.median(one.sending_ms for one in bursts)
    reports = [one.reported for one in bursts if one.reported is not None]
    case = f"{who}, {size} of {name}"
    figures = [
        Figure(_SCENARIO, f"{case}, arrived", arrived, "messages"),
        Figure(_SCENARIO, f"{case}, least arrived", least, "messages"),
        Figure(_SCENARIO, f"{case}, sending", sending_ms, "ms"),
        Figure(_SCENARIO, f"{case}, time", took_ms, "ms"),
    ]
    lost = f"{'-':>15}{'-':>12}"
    if reports:
        reported = statistics.median(reports)
        silent = max(size - one.arrived - (one.reported or 0) for one in bursts)
        lost = f"{reported:15.0f}{silent:12}"
        figures += [
            Figure(_SCENARIO, f"{case}, reported lost", reported, "messages"),
            Figure(_SCENARIO, f"{case}, most lost in silence", silent, "messages"),
        ]
    print(
        f"  {who:16}{name:14}{size:6}{arrived:9.0f}{least:8}{lost}{sending_ms:12.1f}{took_ms:8.1f}",
        flush=True,
    )
    return figures
