# SPDX-License-Identifier: Apache-2.0
"""A base in a separate process: it prints what it hears on ``/cmd_vel``, and when.

A line is the monotonic clock in nanoseconds, which all processes of a machine share, and the speed.
"""

import contextlib
import sys
import time

import rclpy
from geometry_msgs.msg import Twist


def main() -> None:
    rclpy.init()
    node = rclpy.create_node("base")

    def hear(twist: Twist) -> None:
        speed = abs(twist.linear.x) + abs(twist.angular.z)
        sys.stdout.write(f"{time.monotonic_ns()} {speed}\n")
        sys.stdout.flush()

    node.create_subscription(Twist, "/cmd_vel", hear, 1000)
    sys.stdout.write("ready\n")
    sys.stdout.flush()
    with contextlib.suppress(KeyboardInterrupt):
        rclpy.spin(node)


if __name__ == "__main__":
    main()
