# SPDX-License-Identifier: Apache-2.0
"""The time that the event loop spends for each recorded message.

Run ``python -m tests.recording.cost [DIRECTORY]`` on a quiet machine. The source is the fake one,
so that only the way from the source to the queue of the writer counts. Each sample is timed, with
the thread that writes at work. The time of the measurement itself is subtracted. The bound is 10 us
of CPU for a small message, on average.
"""

import argparse
import asyncio
import os
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from gateway.access.audit import Audit
from gateway.access.permissions import UNLIMITED
from gateway.config.recording import RecordingConfig
from gateway.recording.active_recording import RecordingPlan
from gateway.recording.recorder import Recorder
from gateway.sources.source import Sample
from tests.client import eventually
from tests.core.conftest import IMAGE, ODOMETRY, SCAN, Bench, open_bench

SECONDS = 10
RATES_HZ = {"/odom": 500, "/scan": 40, "/image": 30}


def messages(bench: Bench) -> dict[str, tuple[str, bytes]]:
    noise = list(os.urandom(640 * 480 * 3))
    return {
        "/odom": (ODOMETRY, bench.cdr(ODOMETRY)),
        "/scan": (SCAN, bench.cdr(SCAN, ranges=[1.5] * 720)),
        "/image": (IMAGE, bench.cdr(IMAGE, width=640, height=480, step=1920, data=noise)),
    }


async def measure(directory: Path) -> None:
    async with open_bench() as bench:
        robot = messages(bench)
        for topic, (type_name, _) in robot.items():
            bench.ros.add_publisher(topic, type_name)
        audit = Audit(time.time_ns)
        recorder = Recorder(bench.router, bench.types, directory, RecordingConfig(), audit)
        recorder.start(RecordingPlan())
        await eventually(lambda: recorder.status().state != "starting")
        names = set(robot)
        deliver = {
            each.topic: each.on_samples for each in bench.ros.subscriptions if each.topic in names
        }
        due = sorted(
            (number / hz, topic) for topic, hz in RATES_HZ.items() for number in range(SECONDS * hz)
        )
        spent: dict[str, list[tuple[int, int]]] = {topic: [] for topic in robot}
        began_s = time.perf_counter()
        for at_s, topic in due:
            await asyncio.sleep(max(0.0, at_s - (time.perf_counter() - began_s)))
            sample = Sample(robot[topic][1], time.time_ns(), time.time_ns())
            empty_ns = -time.thread_time_ns() + time.thread_time_ns()
            cpu_ns, start_ns = time.thread_time_ns(), time.perf_counter_ns()
            deliver[topic]([sample])
            took_ns = time.perf_counter_ns() - start_ns
            spent[topic].append((time.thread_time_ns() - cpu_ns - empty_ns, took_ns))
        recorder.stop(UNLIMITED)
        await eventually(lambda: not recorder.is_recording)
        status = recorder.status()
    for topic, times in spent.items():
        print(f"{topic}: {line(times)}")  # noqa: T201
    every = [each for times in spent.values() for each in times]
    rate = status.size / 1e6 / status.duration_s
    print(f"all: {line(every)}. {rate:.1f} MB/s, {status.dropped} dropped")  # noqa: T201


def line(times_ns: Sequence[tuple[int, int]]) -> str:
    """Write the CPU time of the loop, and the time by the clock on the wall."""
    ordered = sorted(took for _, took in times_ns)
    p50, p99 = (ordered[int(len(ordered) * share)] / 1000 for share in (0.5, 0.99))
    mean = sum(cpu for cpu, _ in times_ns) / len(times_ns) / 1000
    took = f"took p50 {p50:.1f}, p99 {p99:.1f}, most {ordered[-1] / 1000:.0f} us"
    return f"CPU {mean:.1f} us on average, {took}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("directory", nargs="?", type=Path)
    given = parser.parse_args().directory
    with tempfile.TemporaryDirectory() as temporary:
        asyncio.run(measure(given or Path(temporary)))


if __name__ == "__main__":
    main()
