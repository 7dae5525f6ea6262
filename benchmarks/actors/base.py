# SPDX-License-Identifier: Apache-2.0
"""A robot's base, a bare rclpy process that notes each command on ``/cmd_vel``.

Orders: ``clear``, and ``report``, which answers with the time of each command and its speed.
"""

import contextlib
import time
from typing import Any

import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import ExternalShutdownException
from rclpy.utilities import try_shutdown

from benchmarks.actors.orders import obey, reply


def main() -> None:
    """Listen until the end of stdin."""
    rclpy.init()
    node = rclpy.create_node("base")
    heard: list[tuple[float, float]] = []

    def hear(twist: Any) -> None:
        heard.append((time.monotonic(), twist.linear.x))

    node.create_subscription(Twist, "/cmd_vel", hear, 100)

    def clear() -> bool:
        heard.clear()
        return True

    obey({"clear": clear, "report": lambda: list(heard)}, try_shutdown)
    reply("ready")
    with contextlib.suppress(ExternalShutdownException):
        rclpy.spin(node)


if __name__ == "__main__":
    main()
