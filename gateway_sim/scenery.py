# SPDX-License-Identifier: Apache-2.0
"""The topics for a scene: a cloud by a lidar with several layers, markers, and the way.

The lidar stands in the frame ``base_scan``.
"""

import array
from typing import Final

import numpy as np
from geometry_msgs.msg import Point, PoseStamped
from nav_msgs.msg import Path
from numpy.typing import NDArray
from rclpy.node import Node
from sensor_msgs.msg import PointCloud2, PointField
from std_msgs.msg import ColorRGBA, Header
from visualization_msgs.msg import Marker, MarkerArray

from gateway_sim.lidar import ANGLE_INCREMENT, BEAMS
from gateway_sim.mounts import FIXED
from gateway_sim.robot import Robot
from gateway_sim.robot_messages import offer, quaternion
from gateway_sim.world import Pose, World

RINGS: Final = 16
RANGE_MAX: Final = 10.0  # m: all of the room
_ABOVE: Final = sum(mount.z for mount in FIXED if mount.child in {"base_link", "base_scan"})
_SLOPES: Final = np.tan(np.radians(np.linspace(-25.0, 15.0, RINGS)))
_FLOOR: Final = (90, 96, 104)
_WALL: Final = (200, 204, 208)
_TEXT: Final = 0.15  # m
_DEPTH: Final = 5
_NAMES: Final = ("x", "y", "z", "intensity", "rgb")
_POINT: Final = np.dtype([(name, "<u4" if name == "rgb" else "<f4") for name in _NAMES])

FloatArray = NDArray[np.float64]


class Scenery:
    """The publishers of ``points``, ``markers`` and ``plan``."""

    def __init__(self, node: Node, world: World) -> None:
        self._world = world
        self._points = node.create_publisher(PointCloud2, "points", _DEPTH)
        self._markers = node.create_publisher(MarkerArray, "markers", _DEPTH)
        self._plan = node.create_publisher(Path, "plan", _DEPTH)
        walls = len(world.starts) - sum(len(each.outline) for each in world.obstacles)
        self._heights = np.array(
            [world.height] * walls + [each.height for each in world.obstacles for _ in each.outline]
        )
        colours = [_WALL] * walls + [each.colour for each in world.obstacles for _ in each.outline]
        self._colours = np.array([*colours, _FLOOR], np.uint32) @ np.array(
            [65536, 256, 1], np.uint32
        )

    def publish_points(self, header: Header, robot: Robot) -> None:
        """Publish a turn of the lidar, if anybody looks."""
        offer(self._points, lambda: self._cloud(header, robot.pose))

    def publish_way(self, header: Header, robot: Robot) -> None:
        """Publish the way in the frame of the map, if anybody looks."""
        offer(self._plan, lambda: _way(header, robot))

    def publish_markers(self, header: Header) -> None:
        """Publish the names of what stands on the map, if anybody looks."""
        offer(self._markers, lambda: self._labels(header))

    def _cloud(self, header: Header, pose: Pose) -> PointCloud2:
        angles: FloatArray = np.arange(BEAMS, dtype=np.float64) * ANGLE_INCREMENT
        across = pose.heading + angles
        far = self._world.cast(pose.x, pose.y, np.cos(across), np.sin(across)).distance
        rows = [self._ring(angles, far, float(slope)) for slope in _SLOPES]
        points = np.concatenate(rows)
        data = array.array("B")
        data.frombytes(points.tobytes())
        fields = [
            PointField(name=name, offset=4 * at, datatype=PointField.FLOAT32, count=1)
            for at, name in enumerate(_NAMES)
        ]
        return PointCloud2(
            header=header,
            height=1,
            width=len(points),
            fields=fields,
            point_step=points.itemsize,
            row_step=points.itemsize * len(points),
            data=data,
            is_dense=True,
        )

    def _ring(self, angles: FloatArray, far: FloatArray, slope: float) -> NDArray[np.void]:
        """Return the points of one layer, which sees over what is low."""
        heights = _ABOVE + far * slope
        far = np.where((heights >= 0) & (heights <= self._heights[:, None]), far, np.inf)
        surface = far.argmin(axis=0)
        reach = far.min(axis=0)
        if slope < 0:
            floor = -_ABOVE / slope
            surface = np.where(floor < reach, len(self._heights), surface)
            reach = np.minimum(reach, floor)
        seen = reach < RANGE_MAX
        reach, angles, surface = reach[seen], angles[seen], surface[seen]
        points = np.zeros(len(reach), _POINT)
        points["x"], points["y"] = np.cos(angles) * reach, np.sin(angles) * reach
        points["z"] = reach * slope
        points["intensity"] = 4000 / (1 + reach**2)
        points["rgb"] = self._colours[surface]
        return points

    def _labels(self, header: Header) -> MarkerArray:
        labels = []
        for number, each in enumerate(self._world.obstacles):
            x, y = np.mean(each.outline, axis=0)
            label = _marker(header, "names", number, Marker.TEXT_VIEW_FACING, (1.0, 1.0, 1.0))
            label.text = each.name
            label.scale.z = _TEXT
            label.pose.position = Point(x=x, y=y, z=each.height + _TEXT)
            labels.append(label)
        bay = self._world.bay
        corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
        edge = _marker(header, "bay", 0, Marker.LINE_STRIP, (0.25, 0.75, 0.3))
        edge.scale.x = 0.02
        edge.points = [
            Point(x=bay.x + u * bay.depth / 2, y=bay.y + v * bay.width / 2, z=0.01)
            for u, v in [*corners, corners[0]]
        ]
        return MarkerArray(markers=[*labels, edge])


def _marker(
    header: Header, namespace: str, number: int, kind: int, colour: tuple[float, float, float]
) -> Marker:
    red, green, blue = colour
    marker = Marker(header=header, ns=namespace, id=number, type=kind)
    marker.color = ColorRGBA(r=red, g=green, b=blue, a=1.0)
    marker.pose.orientation.w = 1.0
    return marker


def _way(header: Header, robot: Robot) -> Path:
    """Return the places from the robot to its goal. Without a goal it is empty."""
    path = Path(header=header)
    for x, y in robot.way:
        pose = PoseStamped(header=header)
        pose.pose.position = Point(x=x, y=y)
        pose.pose.orientation = quaternion(0.0 if robot.goal is None else robot.goal.heading)
        path.poses.append(pose)
    return path
