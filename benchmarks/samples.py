# SPDX-License-Identifier: Apache-2.0
"""The messages that are measured, as CDR with a stamp that can be renewed in place."""

import struct
import time
from typing import Any

import numpy as np
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.serialization import serialize_message
from sensor_msgs.msg import Image

STAMP_OFFSET = 4  # behind the encapsulation header: std_msgs/Header comes first in these types


def odometry() -> Odometry:
    """Return a robot's odometry: 708 bytes of CDR."""
    message = Odometry()
    message.header.frame_id = "odom"
    message.child_frame_id = "base_footprint"
    message.pose.pose.position.x = 1.2345678901234
    message.pose.pose.orientation.z = 0.70710678118
    message.pose.covariance[:] = np.linspace(0.0, 1e-3, 36)
    message.twist.twist = Twist()
    message.twist.twist.linear.x = 0.26
    message.twist.covariance[:] = np.linspace(0.0, 1e-3, 36)
    return message


def image() -> Image:
    """Return a VGA picture as busy as a room: soft shapes, edges and sensor noise."""
    y, x = np.mgrid[0:480, 0:640]
    soft = 110 + 60 * np.sin(x / 37.0) + 50 * np.cos(y / 23.0)
    edges = 40 * ((x // 53 + y // 41) % 2)
    noise = np.random.default_rng(1).normal(0, 4, (480, 640, 3))
    pixels = np.clip((soft + edges)[..., None] * (1.0, 0.9, 0.7) + noise, 0, 255).astype(np.uint8)
    message = Image(height=480, width=640, encoding="rgb8", step=640 * 3)
    message.header.frame_id = "camera"
    message.data = pixels.tobytes()
    return message


TYPES: dict[str, Any] = {"odometry": odometry, "image": image}


def cdr(name: str) -> bytearray:
    """Return one of `TYPES` serialised."""
    return bytearray(serialize_message(TYPES[name]()))


def stamp(sample: bytearray) -> bytes:
    """Return the sample as of now."""
    struct.pack_into("<iI", sample, STAMP_OFFSET, *divmod(time.time_ns(), 1_000_000_000))
    return bytes(sample)
