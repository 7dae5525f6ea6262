# SPDX-License-Identifier: Apache-2.0
"""The threads that a message on its way into ROS wakes, counted by the kernel."""

import contextlib
import re
import time
from pathlib import Path

from gateway.sources.source import Qos, Sample
from tests.client import client, eventually
from tests.gateway_process import ALL_TIME, gateway_process
from tests.sources.outside import Outside

MESSAGES = 1000
PERIOD_S = 0.005  # nackSupressionDuration in the gateway's profile
# as small as a Twist, but no command: of commands that arrive together only the newest goes out
ACCEL = "geometry_msgs/msg/Accel"


def timer_wake_ups(pid: int) -> int:
    """Count how often the threads that run Fast DDS' timers have gone to sleep."""
    tasks = Path(f"/proc/{pid}/task").iterdir()
    timers = [task for task in tasks if (task / "comm").read_text().startswith("dds.ev")]
    assert timers
    counts = (
        re.search(r"^voluntary_ctxt_switches:\s+(\d+)", status(task), re.MULTILINE)
        for task in timers
    )
    return sum(int(count[1]) for count in counts if count is not None)


def status(task: Path) -> str:
    return (task / "status").read_text()


async def test_no_timer_is_started_for_each_message_that_a_client_publishes() -> None:
    heard: list[Sample] = []
    with contextlib.closing(Outside()) as outside:
        outside.add_subscription("/accel", ACCEL, heard.extend, Qos(depth=MESSAGES))
        async with gateway_process("serve", *ALL_TIME) as gateway, client(gateway.url) as driver:
            # deep enough for a reader that the machine holds up
            qos = {"depth": MESSAGES}
            await driver.send(op="advertise", topic="/accel", type=ACCEL, qos=qos)
            while not heard:  # discovery takes what it takes
                await driver.send(op="publish", topic="/accel", msg={})
                await driver.sync()
            heard.clear()
            before, started_s = timer_wake_ups(gateway.process.pid), time.monotonic()
            for _ in range(MESSAGES):
                await driver.send(op="publish", topic="/accel", msg={})
            await driver.sync()
            await eventually(lambda: len(heard) >= MESSAGES)
            woken = timer_wake_ups(gateway.process.pid) - before
            periods = (time.monotonic() - started_s) / PERIOD_S
    # one timer for each period, started and run out, however slow the machine is
    assert woken < 4 * (periods + 5)
