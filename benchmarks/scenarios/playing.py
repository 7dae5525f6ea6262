# SPDX-License-Identifier: Apache-2.0
"""Recordings of a robot and of cameras, played to one client, and jumps in a large one.

A message is late by the time from its turn to its arrival at the client. Its turn is so long after
the client has resumed the player as its stamp is after the first one, divided by the speed. Both
processes read the monotonic clock of this machine. So nothing is subtracted.
"""

import contextlib
import json
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from websockets.sync.client import ClientConnection, connect

from benchmarks.figures import Figure
from benchmarks.plan import Plan
from benchmarks.processes import cpu_s, running
from benchmarks.recorded import START_NS, write
from benchmarks.samples import HEADER, RAW_HEADER, Clockwork

_SCENARIO: Final = "play"
_TOPICS: Final = 20
_RATE_HZ: Final = 28.5  # of each: 570 messages per second, as a robot's
_SPEEDS: Final = (1, 10)
_CAMERAS: Final = 2
_CAMERA_HZ: Final = 30
_LARGE_BYTES: Final = 1_000_000_000
_PICTURE_BYTES: Final = 640 * 480 * 3
_SEEKS: Final = 20
_ANSWER_S: Final = 60.0
_QUIET_S: Final = 2.0  # the recording is over


def measure(plan: Plan) -> list[Figure]:
    """Print tables and return the figures.

    Raises:
        BenchmarkError: the packages that read and write recordings are not installed.
    """
    print(f"{_TOPICS} topics of Odometry, {_TOPICS * _RATE_HZ:g} messages per second of recording,")
    print(f"{_CAMERAS} cameras of 640x480 at {_CAMERA_HZ} Hz, raw, which the client gets as JPEG")
    print(f"  {'':9}{'core %':>8}{'CPU us':>8}{'late p50':>9}{'p99':>8}{'max ms':>8}{'come %':>8}")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        figures = []
        for speed in _SPEEDS:
            file = folder / f"robot{speed}.mcap"
            turns = range(round(_RATE_HZ * plan.seconds * speed))
            times = (
                ((turn + number / _TOPICS) / _RATE_HZ, f"/odom{number}")
                for turn in turns
                for number in range(_TOPICS)
            )
            count = write(file, times, "odometry")
            figures += _measure(f"speed {speed}", file, count, speed)
        file = folder / "cameras.mcap"
        times = (
            (turn / _CAMERA_HZ, f"/camera{number}")
            for turn in range(round(_CAMERA_HZ * plan.seconds))
            for number in range(_CAMERAS)
        )
        figures += _measure("cameras", file, write(file, times, "image"), 1)
        return figures + _measure_seeks(folder / "large.mcap")


def _measure(name: str, file: Path, count: int, speed: int) -> list[Figure]:
    is_raw = name != "cameras"
    with _playing(file, speed) as (process_id, client):
        topics = [f"/odom{n}" for n in range(_TOPICS)]
        for topic in topics if is_raw else [f"/camera{n}" for n in range(_CAMERAS)]:
            compression = "cbor-raw" if is_raw else "none"
            _send(client, op="subscribe", topic=topic, compression=compression)
        _call(client, "is_paused")
        spent_s, resumed_ns = cpu_s(process_id), time.monotonic_ns()
        _send(client, op="call_service", service="/rosbag2_player/resume")
        arrivals = _arrivals(client, RAW_HEADER if is_raw else HEADER)
        spent_s = cpu_s(process_id) - spent_s
    took_s = max(stamp for stamp, _ in arrivals) / 1e9 / speed
    late_ms = sorted((came - resumed_ns - stamp / speed) / 1e6 for stamp, came in arrivals)
    p50, p99, most = late_ms[len(late_ms) // 2], late_ms[len(late_ms) * 99 // 100], late_ms[-1]
    delivered = len(arrivals) / count * 100
    us, share = spent_s / len(arrivals) * 1e6, spent_s / took_s * 100
    print(
        f"  {name:9}{share:8.1f}{us:8.1f}{p50:9.1f}{p99:8.1f}{most:8.1f}{delivered:8.1f}",
        flush=True,
    )
    return [
        Figure(_SCENARIO, f"{name}, of a core", share, "%"),
        Figure(_SCENARIO, f"{name}, CPU", us, "us per message"),
        Figure(_SCENARIO, f"{name}, late p50", p50, "ms"),
        Figure(_SCENARIO, f"{name}, late p99", p99, "ms"),
        Figure(_SCENARIO, f"{name}, late max", most, "ms"),
        Figure(_SCENARIO, f"{name}, delivered", delivered, "%"),
    ]


def _measure_seeks(file: Path) -> list[Figure]:
    """Measure from a request to the latched message that ends each jump."""
    count = _LARGE_BYTES // _PICTURE_BYTES
    times = ((turn / _CAMERA_HZ, "/camera") for turn in range(count))
    write(file, times, "image", latched="/map")
    took_ms = []
    with _playing(file, 1) as (_, client):
        _send(client, op="subscribe", topic="/map", compression="cbor-raw")
        _call(client, "is_paused")
        for number in range(_SEEKS):
            at_s = number * 7 % _SEEKS * count // _CAMERA_HZ // _SEEKS  # to and fro
            asked_ns = time.monotonic_ns()
            stamp = {"sec": START_NS // 10**9 + at_s, "nanosec": 1}
            _send(client, op="call_service", service="/rosbag2_player/seek", args={"time": stamp})
            _await_map(client)
            took_ms.append((time.monotonic_ns() - asked_ns) / 1e6)
    took_ms.sort()
    p50, most = took_ms[len(took_ms) // 2], took_ms[-1]
    print(f"  jumps in {file.stat().st_size / 1e9:.2f} GB: {p50:.1f} ms, at most {most:.1f} ms")
    return [
        Figure(_SCENARIO, "jump in 1 GB, p50", p50, "ms"),
        Figure(_SCENARIO, "jump in 1 GB, max", most, "ms"),
    ]


@contextlib.contextmanager
def _playing(file: Path, speed: int) -> Iterator[tuple[int, ClientConnection]]:
    command = (sys.executable, "-m", "gateway", "play", str(file), "--port", "0", "--paused")
    with (
        running("gateway", *command, "--rate", str(speed), "--log-level", "warning") as process,
        connect(process.line_with(r"ws://\S+"), max_size=None) as client,
    ):
        yield process.pid, client


def _send(client: ClientConnection, **operation: object) -> None:
    client.send(json.dumps(operation))


def _call(client: ClientConnection, name: str) -> None:
    _send(client, op="call_service", service=f"/rosbag2_player/{name}", id=name)
    while not isinstance(frame := client.recv(), str) or f'"id":"{name}"' not in frame:
        pass


def _await_map(client: ClientConnection) -> None:
    while not isinstance(client.recv(timeout=_ANSWER_S), bytes):
        pass


def _arrivals(client: ClientConnection, clockwork: Clockwork) -> list[tuple[int, int]]:
    """Return when each message was recorded, from the first one on, and when it has come."""
    found = []
    try:
        while True:
            frame = client.recv(timeout=_QUIET_S)
            came_ns = time.monotonic_ns()
            stamp = clockwork.pattern.search(frame.encode() if isinstance(frame, str) else frame)
            if stamp is not None:
                found.append((clockwork.parse(stamp) - START_NS, came_ns))
    except TimeoutError:
        return found
