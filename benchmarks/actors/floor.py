# SPDX-License-Identifier: Apache-2.0
"""The floor: a process with a bare rclpy subscriber that only records the age of each message.

``SAMPLE HOW`` as arguments. HOW is ``plain`` for the usual code, on the standard executor, or
``raw`` for the least cost: CDR on the events executor, to receive samples of others, Twists only.
Orders: as those of the client.
"""

import struct
import sys
import time
from typing import Any, Final

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.experimental.events_executor import EventsExecutor
from rclpy.signals import SignalHandlerOptions
from rclpy.task import Future

from benchmarks.actors.orders import obey, reply
from benchmarks.actors.report import Ages
from benchmarks.samples import SAMPLES, topic

DEPTH: Final = 32  # as many as the gateway keeps: the losses of both mean the same
_DEPTH_RAW: Final = 1000  # the question is whether a sample was sent
SPIN_S: Final = 1e6  # without an end, the events executor of rclpy 7.1 delivers nothing


def main(name: str, *, raw: bool) -> None:
    """Receive until the end of stdin."""
    ages = Ages()
    sample = SAMPLES[name]
    read = _read_twist if raw else sample.clockwork.read

    def note(message: Any) -> None:
        now_ns = time.time_ns()
        ages.add(read(message), now_ns)

    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node("benchmark_floor")
    depth = _DEPTH_RAW if raw else DEPTH
    node.create_subscription(type(sample.make()), topic(name), note, depth, raw=raw)
    executor = EventsExecutor() if raw else SingleThreadedExecutor()
    executor.add_node(node)
    over: Any = Future()

    def end() -> None:
        over.set_result(None)
        executor.wake()

    obey(
        {
            "count": lambda: len(ages),
            "report": lambda: {name: ages.summary()},
            "clear": ages.clear,
        },
        end,
    )
    reply("ready")
    executor.spin_until_future_complete(over, SPIN_S)
    rclpy.shutdown()


def _read_twist(cdr: bytes) -> int:
    return int(struct.unpack_from("<d", cdr, 4)[0]) * 1000


if __name__ == "__main__":
    main(sys.argv[1], raw=sys.argv[2] == "raw")
