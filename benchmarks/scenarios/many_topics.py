# SPDX-License-Identifier: Apache-2.0
"""A whole robot's topics to a few clients: the cost of a frame, and the share that arrives."""

import time
from typing import Final

from benchmarks.crowds import crowd_of
from benchmarks.figures import Figure
from benchmarks.plan import Plan
from benchmarks.processes import cpu_s, wait_until
from benchmarks.receivers import publishing
from benchmarks.servers import MeasuredServer

_SCENARIO: Final = "many-topics"
_SAMPLE: Final = "odometry"
_TOPICS: Final = 60
_RATE_HZ: Final = 25.0
_CLIENTS: Final = 5
_WARM_UP_S: Final = 2.0
_GRACE_S: Final = 1.0


def measure(plan: Plan) -> list[Figure]:
    """Print a table and return the figures."""
    print(f"{_TOPICS} topics of {_SAMPLE} at {_RATE_HZ:g} Hz each to {_CLIENTS} clients")
    print(f"  {'':16}{'frames/s':>9}{'CPU us per frame':>18}{'% of a core':>13}{'delivered %':>13}")
    return [figure for server in plan.servers for figure in _measure(server, plan.seconds)]


def _measure(server: MeasuredServer, seconds: float) -> list[Figure]:
    rate_hz = _TOPICS * _RATE_HZ
    count = round(rate_hz * seconds)
    with (
        publishing(_SAMPLE, topics=_TOPICS) as publisher,
        server.running() as (url, process),
        crowd_of(url, _SAMPLE, _CLIENTS, _TOPICS) as crowd,
    ):
        wait_until(lambda: publisher.ask("matched") > 0, "all topics are subscribed to")
        publisher.ask("run", rate_hz, round(rate_hz * _WARM_UP_S))
        time.sleep(_GRACE_S)
        before, before_s = crowd.ask("count"), cpu_s(process.pid)
        took_s = publisher.ask("run", rate_hz, count, timeout_s=30 + 10 * seconds)["seconds"]
        time.sleep(_GRACE_S)
        frames, spent_s = crowd.ask("count") - before, cpu_s(process.pid) - before_s
    if not frames:
        frames = 1  # nothing arrived: the share below shows it
    delivered = frames / (count * _CLIENTS)
    us_per_frame, core_share = spent_s / frames * 1e6, spent_s / took_s
    print(
        f"  {server.name:16}{frames / took_s:9.0f}{us_per_frame:18.1f}{core_share * 100:13.1f}"
        f"{delivered * 100:13.2f}",
        flush=True,
    )
    return [
        Figure(_SCENARIO, f"{server.name}, CPU", us_per_frame, "us per frame"),
        Figure(_SCENARIO, f"{server.name}, of a core", core_share * 100, "%"),
        Figure(_SCENARIO, f"{server.name}, delivered", delivered * 100, "%"),
    ]
