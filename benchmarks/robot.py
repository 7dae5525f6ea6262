# SPDX-License-Identifier: Apache-2.0
"""The topics of a robot: a TurtleBot3 with two cameras and Nav2, at the rates of a real one.

All types come with the wheels of ROS. A `TransformStamped` stands for the `TFMessage` of ``/tf``,
which does not, and is an array of them.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped, TransformStamped
from nav_msgs.msg import OccupancyGrid, Path
from rcl_interfaces.msg import Log
from sensor_msgs.msg import (
    BatteryState,
    CameraInfo,
    Imu,
    JointState,
    LaserScan,
    MagneticField,
)
from std_msgs.msg import String

from benchmarks.samples import CBOR_HEADER, HEADER, Clockwork, image, odometry, twist

LATCHED: Final = 0.0
"""The rate of a topic that is published once, and kept for those who subscribe later."""

ODOMETRY: Final = "odom"
CAMERAS: Final = ("camera/image_raw", "rear_camera/image_raw")
AGED: Final = (ODOMETRY, *CAMERAS)
"""The topics whose messages carry the time of sending."""

PICTURE_OPTIONS: Final[Mapping[str, dict[str, Any]]] = {
    "default": {},
    "quality": {"image": {"quality": 50}},
    "max_width": {"image": {"max_width": 320}},
    "max_fps": {"image": {"max_fps": 5}},
    "cbor": {"compression": "cbor"},
}
"""The options of the clients' subscriptions to the cameras, by their names in tables."""


@dataclass(frozen=True)
class RobotTopic:
    """One topic: its message, and the rate or `LATCHED`."""

    make: Callable[[], Any]
    rate_hz: float

    def type_name(self) -> str:
        """Return the ROS name of its type."""
        message_class = type(self.make())
        return f"{message_class.__module__.split('.')[0]}/msg/{message_class.__name__}"


def clockwork(options: str, name: str) -> Clockwork:
    """Return the clockwork of a topic's frames at a client with these picture options."""
    is_cbor = name in CAMERAS and "compression" in PICTURE_OPTIONS[options]
    return CBOR_HEADER if is_cbor else HEADER


def _scan() -> LaserScan:
    """Return 360 ranges and intensities, to the millimetre."""
    message = LaserScan(angle_max=6.28319, angle_increment=0.0175, range_min=0.12, range_max=3.5)
    message.header.frame_id = "base_scan"
    message.ranges = np.round(np.linspace(0.12, 3.5, 360), 3).astype(np.float32).tolist()
    message.intensities = np.linspace(20, 60, 360).round().astype(np.float32).tolist()
    return message


def _imu() -> Imu:
    message = Imu()
    message.header.frame_id = "imu_link"
    message.orientation.z = 0.70710678118
    message.angular_velocity.z = 0.0123456789
    message.linear_acceleration.z = 9.80665
    for covariance in (
        message.orientation_covariance,
        message.angular_velocity_covariance,
        message.linear_acceleration_covariance,
    ):
        covariance[:] = np.linspace(0.0, 1e-3, 9)
    return message


def _magnetic_field() -> MagneticField:
    message = MagneticField()
    message.header.frame_id = "imu_link"
    message.magnetic_field.x = 2.1e-5
    return message


def _joint_states() -> JointState:
    message = JointState(name=["wheel_left_joint", "wheel_right_joint"])
    message.header.frame_id = "base_link"
    message.position, message.velocity = [12.3456789, 12.3456788], [1.25, 1.26]
    message.effort = [0.0, 0.0]
    return message


def _transform() -> TransformStamped:
    message = TransformStamped(child_frame_id="base_footprint")
    message.header.frame_id = "odom"
    message.transform.translation.x = 1.2345678901234
    message.transform.rotation.z = 0.70710678118
    return message


def _battery_state() -> BatteryState:
    return BatteryState(voltage=11.9, percentage=0.83, present=True, location="base")


def _diagnostics() -> DiagnosticArray:
    """Return five parts of the robot with four values each."""
    values = [KeyValue(key=f"value {number}", value="1.2345") for number in range(4)]
    names = ("IMU", "motors", "LIDAR", "battery", "buttons")
    return DiagnosticArray(
        status=[DiagnosticStatus(name=name, message="fine", values=values) for name in names]
    )


def _camera_info() -> CameraInfo:
    message = CameraInfo(width=640, height=480, distortion_model="plumb_bob", d=[0.01] * 5)
    message.header.frame_id = "camera"
    message.k[:] = message.r[:] = np.linspace(0.0, 500.0, 9)
    message.p[:] = np.linspace(0.0, 500.0, 12)
    return message


def _grid(width: int, height: int) -> OccupancyGrid:
    message = OccupancyGrid()
    message.header.frame_id = "map"
    message.info.width, message.info.height, message.info.resolution = width, height, 0.05
    cells = np.random.default_rng(1).choice((-1, 0, 100), width * height, p=(0.4, 0.5, 0.1))
    message.data = cells.astype(np.int8).tolist()
    return message


def _plan() -> Path:
    """Return the way over 2.5 m in steps of a cell."""
    path = Path()
    path.header.frame_id = "map"
    for step in range(50):
        pose = PoseStamped()
        pose.header.frame_id = "map"
        pose.pose.position.x = 0.05 * step
        path.poses.append(pose)
    return path


def _log() -> Log:
    return Log(level=20, name="controller_server", msg="Passing new path to controller.")


def _robot_description() -> String:
    """Return as much text as the URDF of a small robot."""
    return String(data="<link/>" * 1500)


ROBOT: Final[dict[str, RobotTopic]] = {
    ODOMETRY: RobotTopic(odometry, 30),
    "scan": RobotTopic(_scan, 10),
    "imu": RobotTopic(_imu, 100),
    "magnetic_field": RobotTopic(_magnetic_field, 30),
    "joint_states": RobotTopic(_joint_states, 30),
    "tf": RobotTopic(_transform, 30),
    "tf_static": RobotTopic(_transform, LATCHED),
    "battery_state": RobotTopic(_battery_state, 1),
    "cmd_vel": RobotTopic(twist, 10),
    "diagnostics": RobotTopic(_diagnostics, 1),
    "camera/image_raw": RobotTopic(image, 15),
    "camera/camera_info": RobotTopic(_camera_info, 15),
    "rear_camera/image_raw": RobotTopic(image, 15),
    "rear_camera/camera_info": RobotTopic(_camera_info, 15),
    "map": RobotTopic(lambda: _grid(384, 384), LATCHED),
    "local_costmap": RobotTopic(lambda: _grid(60, 60), 2),
    "amcl_pose": RobotTopic(PoseWithCovarianceStamped, 5),
    "plan": RobotTopic(_plan, 1),
    "rosout": RobotTopic(_log, 2),
    "robot_description": RobotTopic(_robot_description, LATCHED),
}
