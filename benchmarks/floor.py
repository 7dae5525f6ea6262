# SPDX-License-Identifier: Apache-2.0
"""The floor: a process with a bare rclpy subscriber that only notes how old each message is."""

import signal
import sys
import time

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.task import Future

from benchmarks.report import Ages
from benchmarks.samples import SAMPLES, topic


def main(name: str) -> None:
    """Receive until SIGINT, then print the ages."""
    ages = Ages()
    sample = SAMPLES[name]
    read = sample.clockwork.read

    def note(message: object) -> None:
        ages.add(time.time_ns() - read(message))

    rclpy.init(signal_handler_options=rclpy.SignalHandlerOptions.NO)
    node = rclpy.create_node("benchmark_floor")
    node.create_subscription(type(sample.make()), topic(name), note, 10)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    # an exception in the midst of rclpy's conversion would come out as another one
    stop = Future()
    signal.signal(signal.SIGINT, lambda *_: stop.set_result(None))
    ages.announce()
    executor.spin_until_future_complete(stop)
    ages.print()
    rclpy.shutdown()


if __name__ == "__main__":
    main(sys.argv[1])
