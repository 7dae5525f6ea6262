# SPDX-License-Identifier: Apache-2.0
"""Publish 0, 1, 2, ... on ``/scan`` at 400 Hz, reliably, until killed, in a separate process.

It discovers a new subscription only while messages are on the way.
"""

import time

import rclpy
from std_msgs.msg import Int32


def main() -> None:
    """Publish."""
    rclpy.init()
    publisher = rclpy.create_node("counting").create_publisher(Int32, "/scan", 1000)
    value = 0
    while True:
        publisher.publish(Int32(data=value))
        value += 1
        time.sleep(0.0025)  # a machine that stands still for a second loses none


if __name__ == "__main__":
    main()
