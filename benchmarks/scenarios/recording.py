# SPDX-License-Identifier: Apache-2.0
"""A robot of 20 topics to 10 clients of all of them, while a gateway records it, and while not."""

import contextlib
import json
import statistics
import tempfile
from collections.abc import Callable, Iterator
from typing import Any, Final, NamedTuple

from websockets.sync.client import ClientConnection, connect

from benchmarks.errors import BenchmarkError
from benchmarks.figures import Figure
from benchmarks.plan import Plan
from benchmarks.processes import Process, running
from benchmarks.scenarios import robot
from benchmarks.servers import gateway_command

_SCENARIO: Final = "record"
_FORMS: Final = (None, "raw", "jpeg")  # of images


class _Round(NamedTuple):
    """One run, and what was recorded of it."""

    run: robot.Run
    mb_per_s: float
    missing: int


def measure(plan: Plan) -> list[Figure]:
    """Print a table and return the figures.

    Raises:
        BenchmarkError: the gateway does not record.
    """
    print(f"  {'recorded':16}{'% of a core':>13}{'odometry, p50 ms':>18}{'p99 ms':>8}", end="")
    print(f"{'MB/s':>8}{'missing':>9}")
    with (
        tempfile.TemporaryDirectory() as directory,
        robot.scene(_gateway(directory)) as (url, run),
        connect(url, max_size=None) as client,
    ):
        rounds = [
            [_round(client, run, images, plan.seconds) for images in _FORMS]
            for _ in range(plan.rounds)
        ]
    return [
        figure
        for column, images in enumerate(_FORMS)
        for figure in _figures(images, [one[column] for one in rounds])
    ]


@contextlib.contextmanager
def _gateway(directory: str) -> Iterator[tuple[str, Process]]:
    setting = f"--set=recording.directory={directory}"
    with running("gateway", *gateway_command(0), setting) as process:
        yield process.line_with(r"ws://\S+"), process


def _round(
    client: ClientConnection, run: Callable[[float], robot.Run], images: str | None, seconds: float
) -> _Round:
    if images is None:
        return _Round(run(seconds), 0, 0)
    _ask(client, action="start", images=images)
    measured = run(seconds)
    made = _ask(client, action="stop")
    missing = made["dropped"] + made["lost"]
    return _Round(measured, made["bytes"] / 1e6 / made["duration_s"], missing)


def _ask(client: ClientConnection, **options: str) -> dict[str, Any]:
    client.send(json.dumps({"op": "record", "id": _SCENARIO, **options}))
    while True:
        frame: dict[str, Any] = json.loads(client.recv())
        if frame.get("id") != _SCENARIO:
            continue
        if frame["op"] != "record":
            raise BenchmarkError(f"the gateway does not record: {frame['msg']}")
        return frame


def _figures(images: str | None, rounds: list[_Round]) -> list[Figure]:
    """Print the row of one form of images."""
    name = "nothing" if images is None else f"images as {images}"
    runs = [one.run for one in rounds]
    core, p50, p99, mb_per_s = (
        statistics.median(values)
        for values in (
            [one.core_share * 100 for one in runs],
            [one.odometry_ms("p50") for one in runs],
            [one.odometry_ms("p99") for one in runs],
            [one.mb_per_s for one in rounds],
        )
    )
    missing = sum(one.missing for one in rounds)
    print(f"  {name:16}{core:13.1f}{p50:18.1f}{p99:8.1f}{mb_per_s:8.1f}{missing:9}", flush=True)
    return [
        Figure(_SCENARIO, f"{name}, of a core", core, "%"),
        Figure(_SCENARIO, f"{name}, odometry p50", p50, "ms"),
        Figure(_SCENARIO, f"{name}, odometry p99", p99, "ms"),
        Figure(_SCENARIO, f"{name}, to the disk", mb_per_s, "MB/s"),
    ]
