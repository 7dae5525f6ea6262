# SPDX-License-Identifier: Apache-2.0
"""The transforms of the simulated robot's frames, on ``/tf`` if tf2_msgs is installed."""

import math
from typing import Any, Final, NamedTuple

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Quaternion, TransformStamped
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Header

from gateway_sim import camera
from gateway_sim.robot import WHEEL_RADIUS, WHEEL_SEPARATION, Robot
from gateway_sim.robot_messages import quaternion
from gateway_sim.world import Pose

_DEPTH: Final = 100  # tf2's own
_ORIGIN: Final = Pose(0.0, 0.0, 0.0)


class _Mount(NamedTuple):
    """The place of a static frame in its parent: metres, and a quaternion's x, y, z, w."""

    parent: str
    child: str
    x: float
    y: float
    z: float
    rotation: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)


_BASE_HEIGHT: Final = 0.01
_HALF: Final = WHEEL_SEPARATION / 2
_WHEEL_HEIGHT: Final = WHEEL_RADIUS - _BASE_HEIGHT
_AXLE: Final = (-math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))  # z along the axle, to the left
_OPTICAL: Final = (-0.5, 0.5, -0.5, 0.5)  # REP 103: z ahead, x to the right, y down
_MOUNTS: Final = (
    _Mount("base_footprint", "base_link", 0.0, 0.0, _BASE_HEIGHT),
    _Mount("base_link", "base_scan", 0.0, 0.0, 0.122),
    _Mount("base_link", "imu_link", 0.0, 0.0, 0.068),
    _Mount("base_link", "camera_link", camera.AHEAD, 0.0, camera.ABOVE - _BASE_HEIGHT),
    _Mount("camera_link", "camera_rgb_optical_frame", 0.0, 0.0, 0.0, _OPTICAL),
    _Mount("base_link", "wheel_left_link", 0.0, _HALF, _WHEEL_HEIGHT, _AXLE),
    _Mount("base_link", "wheel_right_link", 0.0, -_HALF, _WHEEL_HEIGHT, _AXLE),
)


class RobotFrames:
    """The publishers of ``/tf`` and ``/tf_static``; they do nothing if their type is missing."""

    def __init__(self, node: Node, frame_prefix: str) -> None:
        self._prefix = frame_prefix
        self._message_type: Any = None
        try:
            from tf2_msgs.msg import TFMessage  # not among the wheels of PyPI
        except ImportError:
            return
        self._message_type = TFMessage
        self._moving = node.create_publisher(TFMessage, "/tf", _DEPTH)
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self._fixed = node.create_publisher(TFMessage, "/tf_static", latched)
        stamp = node.get_clock().now().to_msg()
        self._fixed.publish(TFMessage(transforms=[self._mounted(stamp, m) for m in _MOUNTS]))

    def publish(self, stamp: Time, robot: Robot) -> None:
        """Publish the moving frames: the drifting odometry, and the robot in its odometry."""
        if self._message_type is None or self._moving.get_subscription_count() == 0:
            return
        moving = [
            self._placed(stamp, "map", "odom", robot.from_odometry(_ORIGIN)),
            self._placed(stamp, "odom", "base_footprint", robot.odometry),
        ]
        self._moving.publish(self._message_type(transforms=moving))

    def _placed(self, stamp: Time, parent: str, child: str, pose: Pose) -> TransformStamped:
        message = self._between(stamp, parent, child)
        message.transform.translation.x = pose.x
        message.transform.translation.y = pose.y
        message.transform.rotation = quaternion(pose.heading)
        return message

    def _mounted(self, stamp: Time, mount: _Mount) -> TransformStamped:
        message = self._between(stamp, mount.parent, mount.child)
        message.transform.translation.x = mount.x
        message.transform.translation.y = mount.y
        message.transform.translation.z = mount.z
        x, y, z, w = mount.rotation
        message.transform.rotation = Quaternion(x=x, y=y, z=z, w=w)
        return message

    def _between(self, stamp: Time, parent: str, child: str) -> TransformStamped:
        return TransformStamped(
            header=Header(stamp=stamp, frame_id=self._prefix + parent),
            child_frame_id=self._prefix + child,
        )
