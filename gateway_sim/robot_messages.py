# SPDX-License-Identifier: Apache-2.0
"""The simulated robot's state as ROS messages, with the frames and units of REP 103 and 105."""

import array
import math
from collections.abc import Callable, Mapping
from typing import Any, Final

import numpy as np
from diagnostic_msgs.msg import DiagnosticStatus, KeyValue
from geometry_msgs.msg import Point, Quaternion
from nav_msgs.msg import OccupancyGrid, Odometry
from numpy.typing import NDArray
from rclpy.publisher import Publisher
from sensor_msgs.msg import BatteryState, CameraInfo, CompressedImage, Image, Imu, JointState
from sensor_msgs.msg import LaserScan as LaserScanMessage
from std_msgs.msg import Header

from gateway_sim import camera, lidar
from gateway_sim.battery import CAPACITY, CELLS, Battery
from gateway_sim.robot import WHEEL_RADIUS, WHEEL_SEPARATION, Robot
from gateway_sim.world import World

MAP_RESOLUTION: Final = 0.05  # m per cell, SLAM's usual
_GRAVITY: Final = 9.81  # m/s², measured upwards by an accelerometer at rest
_FLAT: Final = 1e-9  # a variance of values that cannot change on a floor (filters reject 0)
# Variances: the odometry is good to about 3 cm and 6°, its speeds to 1 cm/s and 2°/s.
_POSE_VARIANCES: Final = (1e-3, 1e-3, _FLAT, _FLAT, _FLAT, 1e-2)
_TWIST_VARIANCES: Final = (1e-4, _FLAT, _FLAT, _FLAT, _FLAT, 1e-3)


def offer(publisher: Publisher, build: Callable[[], Any]) -> None:
    """Build and publish a message if it has subscribers."""
    if publisher.get_subscription_count() > 0:
        publisher.publish(build())


def quaternion(heading: float) -> Quaternion:
    """Return the rotation by *heading* around the vertical."""
    return Quaternion(z=math.sin(heading / 2), w=math.cos(heading / 2))


def heading(rotation: Quaternion) -> float:
    """Return the angle around the vertical, the yaw. The quaternion need not be of length 1."""
    q = rotation
    return math.atan2(2 * (q.w * q.z + q.x * q.y), q.w * q.w + q.x * q.x - q.y * q.y - q.z * q.z)


def odometry(header: Header, child_frame_id: str, robot: Robot) -> Odometry:
    """Return the wheels' estimate of the robot's motion."""
    message = Odometry(header=header, child_frame_id=child_frame_id)
    pose = robot.odometry
    message.pose.pose.position = Point(x=pose.x, y=pose.y)
    message.pose.pose.orientation = quaternion(pose.heading)
    message.pose.covariance[:: 6 + 1] = np.array(_POSE_VARIANCES)
    message.twist.twist.linear.x = robot.linear
    message.twist.twist.angular.z = robot.angular
    message.twist.covariance[:: 6 + 1] = np.array(_TWIST_VARIANCES)
    return message


def imu(header: Header, robot: Robot) -> Imu:
    """Return the values of an inertial sensor in the robot's centre."""
    message = Imu(header=header, orientation=quaternion(robot.pose.heading))
    message.angular_velocity.z = robot.angular
    message.linear_acceleration.x = robot.acceleration
    message.linear_acceleration.y = robot.linear * robot.angular
    message.linear_acceleration.z = _GRAVITY
    message.orientation_covariance[::4] = (1e-4, 1e-4, 1e-3)
    message.angular_velocity_covariance[::4] = 1e-5
    message.linear_acceleration_covariance[::4] = 1e-3
    return message


def joint_state(header: Header, robot: Robot) -> JointState:
    """Return the wheels' angles and speeds."""
    turning = robot.angular * WHEEL_SEPARATION / 2
    return JointState(
        header=header,
        name=["wheel_left_joint", "wheel_right_joint"],
        position=[robot.left_wheel, robot.right_wheel],
        velocity=[
            (robot.linear - turning) / WHEEL_RADIUS,
            (robot.linear + turning) / WHEEL_RADIUS,
        ],
    )


def laser_scan(header: Header, ranges: NDArray[np.float32]) -> LaserScanMessage:
    """Return one turn of the lidar."""
    return LaserScanMessage(
        header=header,
        angle_max=(lidar.BEAMS - 1) * lidar.ANGLE_INCREMENT,
        angle_increment=lidar.ANGLE_INCREMENT,
        scan_time=lidar.SCAN_NS / 1e9,
        time_increment=lidar.SCAN_NS / 1e9 / lidar.BEAMS,
        range_min=lidar.RANGE_MIN,
        range_max=lidar.RANGE_MAX,
        ranges=array.array("f", ranges.tobytes()),
        # near things reflect more, and a beam without an echo has no intensity
        intensities=array.array(
            "f", np.where(np.isfinite(ranges), 4000 / (1 + ranges**2), 0).astype("f4").tobytes()
        ),
    )


def image(header: Header, picture: NDArray[np.uint8]) -> Image:
    """Return an RGB picture uncompressed."""
    rows, columns, channels = picture.shape
    pixels = array.array("B")  # rclpy copies it as one piece, not pixel by pixel
    pixels.frombytes(picture.data)
    return Image(
        header=header,
        height=rows,
        width=columns,
        encoding="rgb8",
        step=columns * channels,
        data=pixels,
    )


def compressed_image(header: Header, jpeg: NDArray[np.uint8]) -> CompressedImage:
    """Return a JPEG picture in the form of image_transport."""
    data = array.array("B")
    data.frombytes(jpeg.data)
    return CompressedImage(header=header, format="rgb8; jpeg compressed bgr8", data=data)


def camera_info(header: Header) -> CameraInfo:
    """Return the calibration of the simulated camera: a pinhole without distortion."""
    f, cx, cy = camera.FOCAL_LENGTH, camera.CENTRE_X, camera.CENTRE_Y
    return CameraInfo(
        header=header,
        height=camera.HEIGHT,
        width=camera.WIDTH,
        distortion_model="plumb_bob",
        d=[0.0] * 5,
        k=[f, 0.0, cx, 0.0, f, cy, 0.0, 0.0, 1.0],
        r=[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        p=[f, 0.0, cx, 0.0, 0.0, f, cy, 0.0, 0.0, 0.0, 1.0, 0.0],
    )


def battery_state(header: Header, battery: Battery) -> BatteryState:
    """Return the state of the battery. Its temperature is not measured."""
    status = BatteryState.POWER_SUPPLY_STATUS_DISCHARGING
    if battery.charging:
        status = BatteryState.POWER_SUPPLY_STATUS_CHARGING
    return BatteryState(
        header=header,
        voltage=CELLS * battery.cell_voltage,
        temperature=math.nan,
        current=battery.current,
        charge=battery.charge,
        capacity=CAPACITY,
        design_capacity=CAPACITY,
        percentage=battery.percentage,
        power_supply_status=status,
        power_supply_health=BatteryState.POWER_SUPPLY_HEALTH_GOOD,
        power_supply_technology=BatteryState.POWER_SUPPLY_TECHNOLOGY_LIPO,
        present=True,
        cell_voltage=[battery.cell_voltage] * CELLS,
        cell_temperature=[math.nan] * CELLS,
        location="base",
        serial_number="SIM-0001",
    )


def occupancy_grid(header: Header, world: World) -> OccupancyGrid:
    """Return the map of the world."""
    cells = world.occupancy(MAP_RESOLUTION)
    message = OccupancyGrid(header=header, data=array.array("b", cells.tobytes()))
    message.info.map_load_time = header.stamp
    message.info.resolution = MAP_RESOLUTION
    message.info.height, message.info.width = cells.shape
    message.info.origin.position.x = world.x_min - MAP_RESOLUTION
    message.info.origin.position.y = world.y_min - MAP_RESOLUTION
    message.info.origin.orientation.w = 1.0
    return message


def diagnostic(name: str, text: str, ok: bool, values: Mapping[str, object]) -> DiagnosticStatus:
    """Return the state of one part of the robot."""
    return DiagnosticStatus(
        level=DiagnosticStatus.OK if ok else DiagnosticStatus.WARN,
        name=name,
        message=text,
        hardware_id="simulated robot",
        values=[KeyValue(key=key, value=str(value)) for key, value in values.items()],
    )
