# SPDX-License-Identifier: Apache-2.0
"""The cost of an idle server: topics exist and have subscribers, but are silent."""

import time
from typing import Final

from benchmarks.crowds import crowd_of
from benchmarks.figures import Figure
from benchmarks.plan import Plan
from benchmarks.processes import cpu_s, wait_until
from benchmarks.receivers import publishing
from benchmarks.servers import MeasuredServer

_SCENARIO: Final = "idle"
_SAMPLE: Final = "odometry"
_TOPICS: Final = 60
_SETTLED_S: Final = 3.0
_SECONDS: Final = 20.0


def measure(plan: Plan) -> list[Figure]:
    """Print a table and return the figures."""
    print(f"{_TOPICS} subscriptions to silent topics, {_SECONDS:g} s")
    return [figure for server in plan.servers for figure in _measure(server)]


def _measure(server: MeasuredServer) -> list[Figure]:
    with (
        publishing(_SAMPLE, topics=_TOPICS) as publisher,
        server.running() as (url, process),
        crowd_of(url, _SAMPLE, 1, _TOPICS),
    ):
        wait_until(lambda: publisher.ask("matched") > 0, "all topics are subscribed to")
        time.sleep(_SETTLED_S)
        before_s, started_s = cpu_s(process.pid), time.monotonic()
        time.sleep(_SECONDS)
        share = (cpu_s(process.pid) - before_s) / (time.monotonic() - started_s)
    print(f"  {server.name:16}{share * 100:6.2f} % of a core", flush=True)
    return [Figure(_SCENARIO, f"{server.name}, of a core", share * 100, "%")]
