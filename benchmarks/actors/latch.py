# SPDX-License-Identifier: Apache-2.0
"""A process that publishes a giant on a latched topic: ``GIANT`` as argument.

It publishes once at the start. ``publish`` has it do so again.
"""

import os
import sys
import threading
from pathlib import Path

import gateway_sim
from benchmarks.actors.orders import obey, reply

os.environ.setdefault(
    "FASTRTPS_DEFAULT_PROFILES_FILE", str(Path(gateway_sim.__path__[0]) / "fastdds_profile.xml")
)


def main(name: str) -> None:
    """Publish as ordered until the end of stdin."""
    import rclpy
    from rclpy.qos import DurabilityPolicy, QoSProfile
    from rclpy.serialization import serialize_message
    from rclpy.signals import SignalHandlerOptions

    from benchmarks.giants import GIANTS, topic

    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node("benchmark_latch")
    message = GIANTS[name].make()
    cdr = serialize_message(message)
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    publisher = node.create_publisher(type(message), topic(name), latched)
    over = threading.Event()

    def publish() -> bool:
        publisher.publish(cdr)
        return True

    publish()
    obey({"publish": publish}, over.set)
    reply("ready")
    over.wait()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main(*sys.argv[1:])
