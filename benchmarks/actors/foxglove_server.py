# SPDX-License-Identifier: Apache-2.0
"""A WebSocket server of foxglove-sdk, fed by the cheapest subscription that rclpy has.

``SAMPLE`` as argument. It answers with its URL, and serves the CDR of every message unchanged.
"""

import sys
from typing import Any

import foxglove
import rclpy
from rclpy.experimental.events_executor import EventsExecutor
from rclpy.signals import SignalHandlerOptions
from rclpy.task import Future

from benchmarks.actors.floor import DEPTH, SPIN_S
from benchmarks.actors.orders import obey, reply
from benchmarks.samples import SAMPLES, message_type, topic


def main(name: str) -> None:
    """Serve until the end of stdin."""
    foxglove.set_log_level("CRITICAL")
    server = foxglove.start_server(port=0)
    kind = message_type(name)
    schema = foxglove.Schema(name=kind, encoding="ros2msg", data=b"")
    channel = foxglove.Channel(topic(name), schema=schema, message_encoding="cdr")
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node("benchmark_foxglove")
    message_class = type(SAMPLES[name].make())
    node.create_subscription(message_class, topic(name), channel.log, DEPTH, raw=True)
    executor = EventsExecutor()
    executor.add_node(node)
    over: Any = Future()

    def end() -> None:
        over.set_result(None)
        executor.wake()

    obey({}, end)
    reply(f"ws://127.0.0.1:{server.port}")
    executor.spin_until_future_complete(over, SPIN_S)
    server.stop()
    rclpy.shutdown()


if __name__ == "__main__":
    main(sys.argv[1])
