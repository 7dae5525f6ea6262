# SPDX-License-Identifier: Apache-2.0
"""Messages of 16 MB, each with the members of a `subscribe` that ask for one form of it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
from geometry_msgs.msg import Point
from nav_msgs.msg import OccupancyGrid
from sensor_msgs.msg import Image, PointCloud2
from std_msgs.msg import Float64MultiArray
from visualization_msgs.msg import Marker

from benchmarks.samples import image, point_cloud

_SIDE: Final = 4000


@dataclass(frozen=True)
class Giant:
    """A large message, and how a client asks for it."""

    make: Callable[[], Any]
    options: Mapping[str, object] = field(default_factory=dict)

    @property
    def type(self) -> str:
        """The ROS name of its type."""
        message_class = type(self.make.__annotations__["return"]())
        return f"{message_class.__module__.split('.')[0]}/msg/{message_class.__name__}"


def topic(name: str) -> str:
    """Return the topic of a giant."""
    return f"/benchmark/giant/{name.replace('-', '_')}"


def grid() -> OccupancyGrid:
    """Return a map of 200 m x 200 m in cells of 5 cm, unknown, free and occupied."""
    message = OccupancyGrid()
    message.header.frame_id = "map"
    message.info.width = message.info.height = _SIDE
    cells = np.random.default_rng(1).choice(np.array([-1, 0, 100], np.int8), _SIDE * _SIDE)
    message.data.frombytes(cells.tobytes())
    return message


def cloud() -> PointCloud2:
    """Return a million points of 16 bytes."""
    message = point_cloud()
    message.height, message.width, message.row_step = 1, 1_000_000, 16_000_000
    message.data = np.random.default_rng(1).bytes(message.row_step)
    return message


def numbers() -> Float64MultiArray:
    """Return two million numbers with all their digits."""
    message = Float64MultiArray()
    message.data.frombytes(np.random.default_rng(1).normal(size=2_000_000).tobytes())
    return message


def picture() -> Image:
    """Return a picture of 5.3 megapixels."""
    return image(2640, 2020)


def marker() -> Marker:
    """Return a line of 650,000 points, each a separate message."""
    message = Marker()
    message.points = [Point(x=0.1 * at, y=1.0, z=2.5) for at in range(650_000)]
    return message


GIANTS: Final[dict[str, Giant]] = {
    "map": Giant(grid),
    "map-png": Giant(grid, {"image": {"format": "png"}}),
    "map-cbor": Giant(grid, {"compression": "cbor"}),
    "cloud": Giant(cloud),
    "cloud-fields": Giant(cloud, {"fields": ["header", "data"]}),
    "cloud-raw": Giant(cloud, {"compression": "cbor-raw"}),
    "numbers": Giant(numbers),
    "picture": Giant(picture, {"image": {"format": "raw"}}),
    "marker": Giant(marker),
    "marker-cbor": Giant(marker, {"compression": "cbor"}),
}
