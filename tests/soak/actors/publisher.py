# SPDX-License-Identifier: Apache-2.0
"""The robot's sensors: a plain rclpy node that publishes all topics of the load, ``EPOCH``."""

import heapq
import os
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import gateway_sim
from benchmarks.actors.orders import obey, reply
from tests.soak.load import CAMERA, NUMBER_BITS, NUMBERS, NUMBERS_DEPTH, ODOMETRY, SCAN, Topic

# big samples need more than the 512 KB that Fast DDS shares by default
os.environ.setdefault(
    "FASTRTPS_DEFAULT_PROFILES_FILE", str(Path(gateway_sim.__path__[0]) / "fastdds_profile.xml")
)
SENSOR_DEPTH = 10


@dataclass(order=True)
class Turn:
    """The next sample of one topic."""

    due_s: float
    period_s: float = field(compare=False)
    send: Callable[[], None] = field(compare=False)


def main(epoch: int) -> None:
    """Publish until the end of stdin."""
    import rclpy
    from rclpy.signals import SignalHandlerOptions
    from std_msgs.msg import UInt64

    from benchmarks.samples import SAMPLES

    over = threading.Event()
    counts: dict[str, int] = {}
    obey({"count": lambda: counts}, over.set)
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node("soak_sensors")
    begin_s = time.monotonic()
    turns: list[Turn] = []

    def add(topic: Topic, send: Callable[[], None]) -> None:
        counts[topic.name] = 0

        def send_one() -> None:
            send()
            counts[topic.name] += 1

        heapq.heappush(turns, Turn(begin_s, 1 / topic.rate_hz, send_one))

    def sensor(topic: Topic, name: str) -> None:
        sample, cdr = SAMPLES[name], SAMPLES[name].cdr()
        publisher: Any = node.create_publisher(type(sample.make()), topic.name, SENSOR_DEPTH)

        def send() -> None:
            sample.clockwork.write(cdr, time.time_ns())
            publisher.publish(bytes(cdr))

        add(topic, send)

    for topic, name in ((CAMERA, "image"), (SCAN, "laser-scan"), (ODOMETRY, "odometry")):
        sensor(topic, name)
    numbers = node.create_publisher(UInt64, NUMBERS.name, NUMBERS_DEPTH)
    add(
        NUMBERS,
        lambda: numbers.publish(UInt64(data=(epoch << NUMBER_BITS) + counts[NUMBERS.name])),
    )
    reply("ready")
    while not over.wait(max(0.0, turns[0].due_s - time.monotonic())):
        turn = turns[0]
        turn.send()
        # if it is late by more than a period, it goes on from now instead of sending a burst
        turn.due_s = max(turn.due_s + turn.period_s, time.monotonic() - turn.period_s)
        heapq.heapreplace(turns, turn)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main(int(sys.argv[1]))
