# SPDX-License-Identifier: Apache-2.0
"""The robot of 20 topics and its 10 clients, while eight processes want a core each.

No process goes before the others. The unit of systemd gives the gateway more.
"""

import contextlib
import statistics
from collections.abc import Iterator
from typing import Final

from benchmarks.figures import Figure
from benchmarks.plan import Plan
from benchmarks.processes import running
from benchmarks.robot import CAMERAS, ODOMETRY, PICTURE_OPTIONS
from benchmarks.scenarios import robot

_SCENARIO: Final = "starved"
_LOOPS: Final = 8
_LOOP: Final = ("sh", "-c", "while :; do :; done")
_ALL_IMAGES: Final = PICTURE_OPTIONS.keys() - {"max_fps"}  # which asks for fewer
_COLUMNS: Final = {
    "odometry arrived": "%",
    "oldest odometry": "ms",
    "all but images arrived": "%",
    "images arrived": "%",
    "of a core": "%",
}


def measure(plan: Plan) -> list[Figure]:
    """Print a table and return the figures."""
    print(f"a robot of 20 topics to 10 clients, next to {_LOOPS} busy loops")
    figures: list[Figure] = []
    for server in plan.servers:
        with busy_loops():
            rounds = [_numbers(one) for one in robot.runs(server, plan)]
        for (name, unit), values in zip(_COLUMNS.items(), zip(*rounds, strict=True), strict=True):
            figures.append(
                Figure(_SCENARIO, f"{server.name}, {name}", statistics.median(values), unit)
            )
            print(f"  {server.name:16}{name:24}{figures[-1].value:8.1f} {unit}", flush=True)
    return figures


def _numbers(run: robot.Run) -> tuple[float, ...]:
    oldest_ms = max(one[ODOMETRY].get("max_ms", float("nan")) for one in run.ages.values())
    return (
        run.share([ODOMETRY]) * 100,
        oldest_ms,
        run.delivered * 100,
        run.share(CAMERAS, _ALL_IMAGES) * 100,
        run.core_share * 100,
    )


@contextlib.contextmanager
def busy_loops() -> Iterator[None]:
    """Run processes that want a core each."""
    with contextlib.ExitStack() as stack:
        for _ in range(_LOOPS):
            stack.enter_context(running("loop", *_LOOP))
        yield
