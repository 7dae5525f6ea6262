# SPDX-License-Identifier: Apache-2.0
"""The cost of each further client of a topic: a frame is made once, and sent often.

The floor is a server without ROS that only writes one prepared frame of the same size to all.
"""

import contextlib
import statistics
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from functools import partial
from typing import Final

from benchmarks.crowds import Load, crowd_of, load
from benchmarks.figures import Figure, ratio
from benchmarks.plan import Plan
from benchmarks.processes import Process, acting
from benchmarks.receivers import publishing
from benchmarks.samples import SAMPLES, message_type, topic
from gateway.codec.json import dumps
from gateway.codec.types import Types
from schemas.installed import InstalledDefinitions

_SCENARIO: Final = "fan-out"
_CLIENTS: Final = (1, 10, 50, 200)
_SAMPLE: Final = "odometry"
_RATE_HZ: Final = 50.0
_ROOM: Final = {"max_clients": max(_CLIENTS), "max_clients_per_address": max(_CLIENTS)}

_Serving = Callable[[], AbstractContextManager[tuple[str, Process]]]


def measure(plan: Plan) -> list[Figure]:
    """Print a table and return the figures.

    The first and the last number of clients give the slope and are measured in every round. Those
    between show that the cost is linear and are measured once.
    """
    serving: dict[str, _Serving] = {"floor": _floor}
    serving |= {server.name: partial(server.running, _ROOM) for server in plan.servers}
    print(f"{_SAMPLE} at {_RATE_HZ:g} Hz to many clients")
    print(f"  {'clients':>7} {'':16}{'frames/s':>9}{'CPU us per frame':>18}", end="")
    print(f"{'% of a core':>13}{'MB':>6}")
    slopes: dict[str, list[float]] = {name: [] for name in serving}
    for round_number in range(plan.rounds):
        counts = _CLIENTS if round_number == 0 else (_CLIENTS[0], _CLIENTS[-1])
        loads: dict[tuple[str, int], Load] = {}
        for clients in counts:
            for name, one in serving.items():
                loads[name, clients] = _load(name, one, clients, plan.seconds)
        for name in serving:
            slopes[name].append(_slope_us(loads[name, counts[0]], loads[name, counts[-1]]))
    return _figures(slopes)


def _load(name: str, serving: _Serving, clients: int, seconds: float) -> Load:
    with (
        publishing(_SAMPLE, _RATE_HZ),
        serving() as (url, server),
        crowd_of(url, _SAMPLE, clients) as crowd,
    ):
        result = load(crowd, server, clients, seconds)
    print(
        f"  {clients:7} {name:16}{result.frames_per_s:9.0f}{result.us_per_frame:18.1f}"
        f"{result.core_share * 100:13.1f}{result.memory_mb:6.0f}",
        flush=True,
    )
    return result


def _slope_us(few: Load, many: Load) -> float:
    """Return the CPU time of one frame to one further client."""
    frames_per_s = many.frames_per_s - few.frames_per_s
    return (many.core_share - few.core_share) / frames_per_s * 1e6


def _figures(slopes: dict[str, list[float]]) -> list[Figure]:
    figures = []
    floor_us = slopes["floor"]
    for name, slope_us in slopes.items():
        median_us = statistics.median(slope_us)
        beside = statistics.median(a / b for a, b in zip(slope_us, floor_us, strict=True))
        print(
            f"  {name}: {median_us:.1f} us per frame to a further client, {beside:.2f} of the floor"
        )
        figures.append(Figure(_SCENARIO, f"{name}, further client", median_us, "us per frame"))
        if name != "floor":
            figures.append(ratio(_SCENARIO, f"{name}, further client beside the floor's", beside))
    return figures


@contextlib.contextmanager
def _floor() -> Iterator[tuple[str, Process]]:
    with acting("fan_floor", _frame_bytes(), _RATE_HZ) as server:
        yield server.answer(), server


def _frame_bytes() -> int:
    """Return the size of the frames that the gateway sends."""
    decode = Types(InstalledDefinitions()).get(message_type(_SAMPLE)).decode
    message = dumps(decode(bytes(SAMPLES[_SAMPLE].cdr())))
    return len(f'{{"op":"publish","topic":"{topic(_SAMPLE)}","msg":}}') + len(message)
