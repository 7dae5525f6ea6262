# SPDX-License-Identifier: Apache-2.0
"""The measured messages, as CDR in which the time of sending can be replaced in place.

It is the stamp of types with a header, the text of a String, the first number of a Twist.
"""

import re
import struct
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.serialization import serialize_message
from sensor_msgs.msg import CompressedImage, Image, LaserScan, PointCloud2, PointField
from std_msgs.msg import String

_ENCAPSULATION: Final = 4  # bytes before the first field of every CDR message
_LENGTH: Final = 4  # bytes before the characters of a string
_DIGITS: Final = 19  # of nanoseconds since 1970, until 2286


@dataclass(frozen=True)
class Clockwork:
    """Functions that write and read the time of sending in messages of a type."""

    write: Callable[[bytearray, int], None]
    """Write it, in nanoseconds, into a message as CDR."""
    read: Callable[[Any], int]
    """Read it from a message of rclpy's."""
    pattern: "re.Pattern[bytes]"
    """Finds it in a frame, in JSON with any white space.

    A full parse would measure the client instead.
    """
    parse: Callable[["re.Match[bytes]"], int]


@dataclass(frozen=True)
class SampleKind:
    """One kind of message, and the rate at which it is compared with the floor."""

    make: Callable[[], Any]
    rate_hz: float
    clockwork: Clockwork
    compression: str = "none"
    """The ``compression`` of a client's subscription."""

    def cdr(self) -> bytearray:
        """Return the message serialised."""
        return bytearray(serialize_message(self.make()))


def _nanoseconds(sec: int, nanosec: int) -> int:
    return sec * 1_000_000_000 + nanosec


HEADER: Final = Clockwork(
    lambda sample, now_ns: struct.pack_into(
        "<iI", sample, _ENCAPSULATION, *divmod(now_ns, 1_000_000_000)
    ),
    lambda message: _nanoseconds(message.header.stamp.sec, message.header.stamp.nanosec),
    re.compile(rb'"stamp": ?\{"sec": ?(\d+), ?"nanosec": ?(\d+)\}'),
    lambda found: _nanoseconds(int(found[1]), int(found[2])),
)
# the same in CDR within CBOR, where 2 bytes after 0x59, or 4 after 0x5a, are the length (RFC 8949,
# section 3)
RAW_HEADER: Final = replace(
    HEADER,
    pattern=re.compile(rb"bytes(?:\x59..|\x5a.{4})\0\x01..(.{8})", re.DOTALL),
    parse=lambda found: _nanoseconds(*struct.unpack("<iI", found[1])),
)
# the same in CBOR: each key is a text, 0x1a and 4 bytes are a number of 2**16 and more (RFC 8949,
# section 3). Of 15,000 stamps one has a smaller ``nanosec``: it is passed over.
CBOR_HEADER: Final = replace(
    HEADER,
    pattern=re.compile(rb"\x63sec\x1a(.{4})\x67nanosec\x1a(.{4})", re.DOTALL),
    parse=lambda found: _nanoseconds(*(int.from_bytes(one, "big") for one in found.groups())),
)
_TEXT: Final = Clockwork(
    lambda sample, now_ns: struct.pack_into(
        f"{_DIGITS}s", sample, _ENCAPSULATION + _LENGTH, b"%d" % now_ns
    ),
    lambda message: int(message.data),
    re.compile(rb'"data": ?"(\d+)"'),
    lambda found: int(found[1]),
)
# microseconds, which a double holds exactly
_NUMBER: Final = Clockwork(
    lambda sample, now_ns: struct.pack_into("<d", sample, _ENCAPSULATION, now_ns // 1000),
    lambda message: int(message.linear.x) * 1000,
    re.compile(rb'"linear": ?\{"x": ?([\d.e+]+)'),
    lambda found: int(float(found[1])) * 1000,
)


OFFERED_IMAGE: Final = "image/compressed"  # the image as an uplink offers it


def topic(name: str, number: int = 0) -> str:
    """Return the topic of a sample, or one of many."""
    return f"/benchmark/{name.replace('-', '_')}" + (f"_{number}" if number else "")


def message_type(name: str) -> str:
    """Return the ROS name of a sample's type."""
    message_class = type(SAMPLES[name].make())
    return f"{message_class.__module__.split('.')[0]}/msg/{message_class.__name__}"


def string() -> String:
    """Return a text of the length of a time."""
    return String(data="0" * _DIGITS)


def twist() -> Twist:
    """Return a velocity."""
    message = Twist()
    message.linear.x = 1.0
    message.angular.z = 1.82
    return message


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


def laser_scan() -> LaserScan:
    """Return 720 ranges as a scanner measures them, to the millimetre, and 720 intensities."""
    message = LaserScan(angle_min=-3.14159, angle_max=3.14159, angle_increment=0.00872665)
    message.header.frame_id = "base_scan"
    message.range_min, message.range_max = 0.12, 3.5
    message.ranges = np.round(np.linspace(0.12, 3.5, 720), 3).astype(np.float32).tolist()
    message.intensities = np.linspace(20, 60, 720).round().astype(np.float32).tolist()
    return message


def image(width: int = 640, height: int = 480) -> Image:
    """Return a picture as busy as a room: soft shapes, edges and sensor noise."""
    y, x = np.mgrid[0:height, 0:width]
    soft = 110 + 60 * np.sin(x / 37.0) + 50 * np.cos(y / 23.0)
    edges = 40 * ((x // 53 + y // 41) % 2)
    noise = np.random.default_rng(1).normal(0, 4, (height, width, 3))
    pixels = np.clip((soft + edges)[..., None] * (1.0, 0.9, 0.7) + noise, 0, 255).astype(np.uint8)
    message = Image(height=height, width=width, encoding="rgb8", step=width * 3)
    message.header.frame_id = "camera"
    message.data = pixels.tobytes()
    return message


def compressed_image() -> CompressedImage:
    """Return 60 kB, which nothing decodes on its path."""
    message = CompressedImage(format="jpeg")
    message.header.frame_id = "camera"
    message.data = np.random.default_rng(1).bytes(60_000)
    return message


def point_cloud() -> PointCloud2:
    """Return 76,800 points of 16 bytes: 1.2 MB."""
    message = PointCloud2(height=240, width=320, point_step=16, row_step=5120, is_dense=True)
    message.header.frame_id = "camera"
    message.fields = [
        PointField(name=name, offset=4 * at, datatype=PointField.FLOAT32, count=1)
        for at, name in enumerate(("x", "y", "z", "rgb"))
    ]
    message.data = np.random.default_rng(1).bytes(1_228_800)
    return message


SAMPLES: Final[dict[str, SampleKind]] = {
    "string": SampleKind(string, 1000, _TEXT),
    "twist": SampleKind(twist, 1000, _NUMBER),
    "odometry": SampleKind(odometry, 1000, HEADER),
    "laser-scan": SampleKind(laser_scan, 1000, HEADER),
    "image": SampleKind(image, 30, HEADER),
    "image-1080p": SampleKind(lambda: image(1920, 1080), 30, HEADER),
    OFFERED_IMAGE: SampleKind(compressed_image, 30, HEADER),
    "compressed-image": SampleKind(compressed_image, 200, HEADER),
    "point-cloud": SampleKind(point_cloud, 30, HEADER),
    "point-cloud-raw": SampleKind(point_cloud, 30, RAW_HEADER, "cbor-raw"),
}
