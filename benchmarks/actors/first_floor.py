# SPDX-License-Identifier: Apache-2.0
"""A process with rclpy subscribers, each created by an order and closed by its first message.

``SAMPLE`` as argument. Order: ``subscribe``. Answers with ``waiting`` once the subscription
exists, then with the times of the order and of the message, in nanoseconds.
"""

import queue
import sys
import time
from typing import Any

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions
from rclpy.task import Future
from rclpy.utilities import try_shutdown

from benchmarks.actors.orders import obey, reply
from benchmarks.samples import SAMPLES, topic


def main(name: str) -> None:
    """Subscribe as ordered until the end of stdin."""
    message_class = type(SAMPLES[name].make())
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node("benchmark_first_floor")
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    jobs: queue.SimpleQueue[bool] = queue.SimpleQueue()

    def end() -> None:
        jobs.put(False)
        try_shutdown()  # wakes the executor

    obey({"subscribe": lambda: jobs.put(True)}, end)
    reply("ready")
    while jobs.get():
        first: Any = Future(executor=executor)

        def note(_: object, first: Any = first) -> None:
            if not first.done():
                first.set_result(time.time_ns())

        asked_ns = time.time_ns()
        subscription = node.create_subscription(message_class, topic(name), note, 10)
        reply("waiting")
        executor.spin_until_future_complete(first)
        node.destroy_subscription(subscription)
        if first.done():
            reply([asked_ns, first.result()])


if __name__ == "__main__":
    main(sys.argv[1])
