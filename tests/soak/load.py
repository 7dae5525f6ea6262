# SPDX-License-Identifier: Apache-2.0
"""The topics of the load, and how clients subscribe to them."""

from dataclasses import dataclass
from typing import Any, Final

NUMBER_BITS: Final = 32  # of a number within its epoch, below the epoch: see `sequence`


@dataclass(frozen=True)
class Topic:
    """One topic of the simulated robot."""

    name: str
    type_name: str
    rate_hz: float


CAMERA: Final = Topic("/soak/camera", "sensor_msgs/msg/Image", 30)
SCAN: Final = Topic("/soak/scan", "sensor_msgs/msg/LaserScan", 10)
ODOMETRY: Final = Topic("/soak/odom", "nav_msgs/msg/Odometry", 50)
NUMBERS: Final = Topic("/soak/numbers", "std_msgs/msg/UInt64", 50)

TOPICS: Final = (CAMERA, SCAN, ODOMETRY, NUMBERS)

# Twenty seconds of numbers may wait, in DDS and for a client: longer than a machine stands still.
NUMBERS_DEPTH: Final = 1000


def subscribe(topic: Topic, *, meta: bool = False) -> dict[str, Any]:
    """Return the operation that subscribes to a topic."""
    operation: dict[str, Any] = {
        "op": "subscribe",
        "topic": topic.name,
        "type": topic.type_name,
        "meta": meta,
    }
    if topic is NUMBERS:
        operation["queue_length"] = NUMBERS_DEPTH
        operation["qos"] = {"reliability": "reliable", "depth": NUMBERS_DEPTH}
    return operation
