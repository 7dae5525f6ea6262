# SPDX-License-Identifier: Apache-2.0
"""The transforms of the simulated robot's frames, on ``/tf`` and ``/tf_static``."""

import math
from typing import Any, Final

from builtin_interfaces.msg import Time
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile

from gateway_sim.any_types import AnyTypes, MissingTypeError, ValuePublisher
from gateway_sim.mounts import FIXED, LEFT_WHEEL, RIGHT_WHEEL, Mount, Rotation
from gateway_sim.robot import Robot
from gateway_sim.world import Pose

TF_MESSAGE: Final = "tf2_msgs/msg/TFMessage"
_DEPTH: Final = 100  # tf2's own
_ORIGIN: Final = Pose(0.0, 0.0, 0.0)

_Transform = dict[str, Any]


class RobotFrames:
    """The publishers of ``/tf`` and ``/tf_static``.

    They are there once `open` was called, or never, with a warning in the node's log that says why.
    """

    def __init__(self, node: Node, frame_prefix: str) -> None:
        self._node = node
        self._prefix = frame_prefix
        self._moving: ValuePublisher | None = None

    def publish(self, stamp: Time, robot: Robot) -> None:
        """Publish the frames that move: the drifting odometry, the robot in it, its wheels."""
        if self._moving is None or not self._moving.has_subscribers():
            return
        moving = [
            self._placed(stamp, "map", "odom", robot.from_odometry(_ORIGIN)),
            self._placed(stamp, "odom", "base_footprint", robot.odometry),
            self._mounted(stamp, LEFT_WHEEL, LEFT_WHEEL.turned(robot.left_wheel)),
            self._mounted(stamp, RIGHT_WHEEL, RIGHT_WHEEL.turned(robot.right_wheel)),
        ]
        self._moving.publish({"transforms": moving})

    def open(self, types: AnyTypes, stamp: Time) -> None:
        """Open the topics, and publish the frames that do not move."""
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        try:
            fixed = types.publisher(self._node, TF_MESSAGE, "/tf_static", latched)
            self._moving = types.publisher(self._node, TF_MESSAGE, "/tf", _DEPTH)
        except MissingTypeError as error:
            self._node.get_logger().warning(f"no transforms on /tf: {error}")
            return
        mounted = [self._mounted(stamp, mount, mount.rotation) for mount in FIXED]
        fixed.publish({"transforms": mounted})

    def _placed(self, stamp: Time, parent: str, child: str, pose: Pose) -> _Transform:
        half = pose.heading / 2
        rotation = (0.0, 0.0, math.sin(half), math.cos(half))
        return self._between(stamp, parent, child, (pose.x, pose.y, 0.0), rotation)

    def _mounted(self, stamp: Time, mount: Mount, rotation: Rotation) -> _Transform:
        place = (mount.x, mount.y, mount.z)
        return self._between(stamp, mount.parent, mount.child, place, rotation)

    def _between(
        self,
        stamp: Time,
        parent: str,
        child: str,
        place: tuple[float, float, float],
        rotation: Rotation,
    ) -> _Transform:
        """Return a geometry_msgs/msg/TransformStamped as values."""
        header_stamp = {"sec": stamp.sec, "nanosec": stamp.nanosec}
        return {
            "header": {"stamp": header_stamp, "frame_id": self._prefix + parent},
            "child_frame_id": self._prefix + child,
            "transform": {
                "translation": dict(zip("xyz", place, strict=True)),
                "rotation": dict(zip("xyzw", rotation, strict=True)),
            },
        }
