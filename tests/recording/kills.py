# SPDX-License-Identifier: Apache-2.0
"""Kill recordings at random moments, and show how much each of them has lost.

Run ``python -m tests.recording.kills [TIMES]`` on a quiet machine. A killed recording may lose the
last second.
"""

import argparse
import asyncio
import contextlib
import os
import random
import signal
import tempfile
import time
from pathlib import Path

from gateway.recording.folder import repair_all
from gateway.sources.source import Qos
from tests.recording.process import record_process
from tests.recording.readers import by_all
from tests.recording.test_mcap_file import CONFIG

STRING = "std_msgs/msg/String"
RATE_HZ = 200
MOST_S = 6.0


def string(number: int) -> bytes:
    text = b"%07d\0" % number
    return b"\0\1\0\0" + len(text).to_bytes(4, "little") + text


async def lost_s(directory: Path) -> float:
    """Record, kill, repair, and return how old the newest message was that is missing."""
    from tests.sources.outside import Outside

    with contextlib.closing(Outside()) as outside:
        publisher = outside.add_publisher("/count", STRING, Qos("reliable", depth=1000))
        async with record_process(directory, "-t", "/count") as recording:
            while not publisher.subscribers:  # noqa: ASYNC110  # of another process
                await asyncio.sleep(0.01)
            sent_s: list[float] = []
            end_s = time.monotonic() + random.uniform(0, MOST_S)
            while time.monotonic() < end_s or not sent_s:
                publisher.publish(string(len(sent_s)))
                sent_s.append(time.monotonic())
                await asyncio.sleep(1 / RATE_HZ)
            killed_s = time.monotonic()
            await recording.end(signal.SIGKILL)
    repair_all(directory, CONFIG, "test")
    found = by_all(recording.folder).get("/count", [])
    assert found == [string(number) for number in range(len(found))]
    return killed_s - sent_s[len(found)] if len(found) < len(sent_s) else 0.0


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    times = parser.add_argument("times", nargs="?", type=int, default=20)
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    worst = 0.0
    with tempfile.TemporaryDirectory() as folder:
        for number in range(getattr(parser.parse_args(), times.dest)):
            lost = asyncio.run(lost_s(Path(folder) / str(number)))
            worst = max(worst, lost)
            print(f"kill {number + 1}: lost the last {lost:.2f} s")  # noqa: T201
    print(f"at most {worst:.2f} s, no gaps")  # noqa: T201


if __name__ == "__main__":
    main()
