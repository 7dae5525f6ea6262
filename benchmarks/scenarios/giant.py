# SPDX-License-Identifier: Apache-2.0
"""Odometry for one client, while others get messages of 16 MB: its age, and what it loses.

Each giant is latched. One client gets it from the beginning, and once more when it is published
again. The others come late, one after the other.
"""

import statistics
import time
from typing import Any, Final

from benchmarks.figures import Figure
from benchmarks.giants import GIANTS
from benchmarks.plan import Plan
from benchmarks.processes import Process, acting, wait_until
from benchmarks.receivers import publishing
from benchmarks.servers import MeasuredServer

_SCENARIO: Final = "giant"
_SAMPLE: Final = "odometry"
_RATE_HZ: Final = 100.0
_LATE: Final = 3
_AGAIN: Final = 2
_SETTLED_S: Final = 1.0
_TIMEOUT_S: Final = 120.0


def measure(plan: Plan) -> list[Figure]:
    """Print a table and return the figures."""
    print(f"{_SAMPLE} at {_RATE_HZ:g} Hz next to messages of 16 MB, ms")
    print(f"  {'':16}{'beside':14}{'p50':>8}{'p99':>8}{'max':>8}{'lost':>8}", end="")
    print(f"{'MB':>8}{'first, ms':>11}{'late, ms':>10}")
    figures: list[Figure] = []
    with publishing(_SAMPLE) as publisher:
        for server in plan.servers:
            with server.running() as (url, _), acting("client", url, _SAMPLE) as client:
                client.answer()
                _settle(publisher, client)
                figures += _without(server, publisher, client, plan.seconds)
                for name in GIANTS:
                    figures += _beside(server, url, name, publisher, client)
    return figures


def _settle(publisher: Process, client: Process) -> None:
    publisher.ask("run", _RATE_HZ, 1)

    def has_come() -> bool:
        publisher.ask("run", _RATE_HZ, 1)
        return bool(client.ask("count"))

    wait_until(has_come, f"a client gets {_SAMPLE}")
    publisher.ask("run", _RATE_HZ, int(_RATE_HZ * _SETTLED_S))
    time.sleep(_SETTLED_S)


def _without(
    server: MeasuredServer, publisher: Process, client: Process, seconds: float
) -> list[Figure]:
    client.ask("clear")
    sent = publisher.ask("run", _RATE_HZ, int(_RATE_HZ * seconds))["sent"]
    return _row(server, "nothing", sent, client, "")


def _beside(
    server: MeasuredServer, url: str, name: str, publisher: Process, client: Process
) -> list[Figure]:
    with acting("latch", name) as latch, acting("late", url, name) as late:
        latch.answer(_TIMEOUT_S)
        late.answer()
        client.ask("clear")
        publisher.ask("go", _RATE_HZ)
        time.sleep(_SETTLED_S)
        first = late.ask("stay", timeout_s=_TIMEOUT_S)
        joins = []
        for _ in range(_LATE):
            joins.append(late.ask("join", timeout_s=_TIMEOUT_S))
            time.sleep(_SETTLED_S)
        for _ in range(_AGAIN):
            latch.ask("publish")
            time.sleep(_SETTLED_S)
        sent = publisher.ask("stop")["sent"]
    late_ms = statistics.median(one["ms"] for one in joins)
    return _row(server, name, sent, client, f"{first['mb']:8.1f}{first['ms']:11.0f}{late_ms:10.0f}")


def _row(
    server: MeasuredServer, beside: str, sent: int, client: Process, rest: str
) -> list[Figure]:
    time.sleep(_SETTLED_S)
    seen: dict[str, Any] = client.ask("report")[_SAMPLE]
    lost = sent - seen["distinct"]
    line = f"  {server.name:16}{beside:14}"
    figures = []
    for what in ("p50", "p99", "max"):
        value = seen[f"{what}_ms"]
        line += f"{value:8.2f}"
        figures.append(Figure(_SCENARIO, f"{server.name} beside {beside}, {what}", value, "ms"))
    figures.append(Figure(_SCENARIO, f"{server.name} beside {beside}, lost", lost))
    print(f"{line}{lost:8d}{rest}", flush=True)
    return figures
