# SPDX-License-Identifier: Apache-2.0
"""The simulated robot in a separate process behaves on its topics like a real one."""

import math
import re
import signal
import time

import cv2
import numpy as np
import pytest
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped, Twist, TwistStamped
from nav_msgs.msg import OccupancyGrid, Odometry, Path
from rcl_interfaces.msg import Log
from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import (
    BatteryState,
    CameraInfo,
    CompressedImage,
    Image,
    Imu,
    JointState,
    LaserScan,
    PointCloud2,
)
from std_msgs.msg import String
from std_srvs.srv import SetBool, Trigger
from visualization_msgs.msg import MarkerArray

from gateway.errors import ConfigError
from gateway_sim.node import SimOptions
from gateway_sim.robot_description import urdf
from gateway_sim.robot_messages import heading, quaternion
from gateway_sim.world import furnished_room
from tests.gateway_sim.ros import TIMEOUT_S, Watcher, child

SIMULATION = """
from gateway_sim.node import SimOptions, run
raise SystemExit(run(SimOptions({options})))
"""
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
LOG = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)


@pytest.fixture(scope="module")
def simulation():
    with child(SIMULATION.format(options="seed=1")) as process:
        yield process


@pytest.fixture
def watcher(simulation):
    watcher = Watcher("watcher")
    yield watcher
    watcher.close()


@pytest.fixture
def robot(watcher):
    return RemoteRobot(watcher)


class RemoteRobot:
    """The robot as its topics show it, back at its start."""

    def __init__(self, watcher):
        self.watcher = watcher
        self.odometry = watcher.subscribe(Odometry, "/odom")
        self.log = watcher.subscribe(Log, "/rosout")
        self.commands = watcher.node.create_publisher(Twist, "/cmd_vel", 10)
        watcher.until(lambda: self.odometry, what="/odom")
        watcher.until(lambda: self.commands.get_subscription_count(), what="/cmd_vel")
        watcher.call(SetBool, "/motor_power", SetBool.Request(data=True))
        assert watcher.call(Trigger, "/reset", Trigger.Request()).success
        watcher.until(lambda: self.x == self.speed == 0, what="the reset")

    @property
    def x(self):
        return self.odometry[-1].pose.pose.position.x

    @property
    def y(self):
        return self.odometry[-1].pose.pose.position.y

    @property
    def heading(self):
        return heading(self.odometry[-1].pose.pose.orientation)

    @property
    def speed(self):
        return self.odometry[-1].twist.twist.linear.x

    def command(self, linear, angular=0.0):
        twist = Twist()
        twist.linear.x, twist.angular.z = linear, angular
        self.commands.publish(twist)

    def logged(self, text):
        return [entry for entry in self.log if text in entry.msg]

    def until_published_to(self, publisher, message, condition, what):
        """Publish until it shows: discovery counts subscribers before samples reach them."""
        self.watcher.until(condition, lambda: publisher.publish(message), what)


def test_every_topic_delivers(watcher):
    for message_type, topic in (
        (Odometry, "/odom"),
        (Imu, "/imu"),
        (JointState, "/joint_states"),
        (LaserScan, "/scan"),
        (BatteryState, "/battery_state"),
        (DiagnosticArray, "/diagnostics"),
        (Image, "/camera/image_raw"),
        (CompressedImage, "/camera/image_raw/compressed"),
        (CameraInfo, "/camera/camera_info"),
        (PointCloud2, "/points"),
        (MarkerArray, "/markers"),
        (Path, "/plan"),
    ):
        watcher.subscribe(message_type, topic)
    watcher.until(lambda: all(watcher.received.values()), what="a message on each topic")
    last = {topic: messages[-1] for topic, messages in watcher.received.items()}
    for topic, frame_id in (
        ("/odom", "odom"),
        ("/imu", "imu_link"),
        ("/scan", "base_scan"),
        ("/points", "base_scan"),
        ("/plan", "map"),
        ("/camera/image_raw", "camera_rgb_optical_frame"),
        ("/camera/image_raw/compressed", "camera_rgb_optical_frame"),
        ("/camera/camera_info", "camera_rgb_optical_frame"),
    ):
        header = last[topic].header
        assert header.frame_id == frame_id
        assert abs(header.stamp.sec - time.time()) < TIMEOUT_S
    assert last["/odom"].child_frame_id == "base_footprint"
    assert last["/imu"].linear_acceleration.z == pytest.approx(9.81)
    assert last["/joint_states"].name == ["wheel_left_joint", "wheel_right_joint"]
    assert len(last["/scan"].ranges) == 360
    assert last["/scan"].ranges[180] == pytest.approx(2.0, abs=0.05), "the west wall"
    assert 0.5 < last["/battery_state"].percentage <= 1
    cloud = last["/points"]
    places = np.frombuffer(cloud.data, "<f4").reshape(cloud.width, 5)[:, :3]
    assert places.min(axis=0) == pytest.approx([-2.0, -2.5, -0.132], abs=0.05), "walls and floor"
    assert places.max(axis=0)[:2] == pytest.approx([4.0, 2.5], abs=0.05)
    assert {each.text for each in last["/markers"].markers} >= {"red crate", "violet pillar"}
    assert last["/plan"].poses == []
    names = [status.name for status in last["/diagnostics"].status]
    assert names == ["motors", "battery", "lidar", "camera"]


def test_the_jpeg_shows_the_raw_picture(watcher):
    raw = watcher.subscribe(Image, "/camera/image_raw")
    jpeg = watcher.subscribe(CompressedImage, "/camera/image_raw/compressed")
    info = watcher.subscribe(CameraInfo, "/camera/camera_info")
    watcher.until(lambda: raw and jpeg and info, what="pictures")
    image = raw[-1]
    assert (image.width, image.height, image.encoding, image.step) == (640, 480, "rgb8", 1920)
    pixels = np.frombuffer(image.data, np.uint8).reshape(480, 640, 3)
    decoded = cv2.imdecode(np.frombuffer(jpeg[-1].data, np.uint8), cv2.IMREAD_COLOR)
    assert np.abs(decoded[:, :, ::-1].astype(int) - pixels).mean() < 5
    assert (info[-1].width, info[-1].height) == (640, 480)
    assert info[-1].k[0] == info[-1].p[0] == pytest.approx(420)


def test_commands_move_it_and_silence_stops_it(robot):
    robot.watcher.until(lambda: robot.x > 0.1, lambda: robot.command(0.26), "motion")
    assert robot.speed == pytest.approx(0.26, abs=0.05)
    robot.watcher.until(lambda: robot.speed == 0, what="the stop after silence")
    robot.watcher.until(lambda: robot.logged("cmd_vel is silent"), what="the log")
    assert robot.x < 0.6
    assert robot.y == pytest.approx(0, abs=0.02)


def test_a_command_beyond_the_limits_is_dismissed_and_logged_once(robot):
    robot.watcher.until(lambda: robot.x > 0.02, lambda: robot.command(0.1), "motion")
    # on a busy machine a command may still be under way when the robot has stopped once
    seen = len(robot.odometry)

    def has_stopped():
        last = [odometry.twist.twist.linear.x for odometry in robot.odometry[seen:][-60:]]
        return len(last) == 60 and not any(last)

    robot.watcher.until(has_stopped, what="the stop")
    rest = robot.x
    seen = len(robot.odometry)
    robot.watcher.until(
        lambda: robot.logged("linear.x 0.5") and len(robot.odometry) > seen + 30,
        lambda: robot.command(0.5),
        "the dismissal",
    )
    assert robot.x == rest
    assert len(robot.logged("linear.x 0.5 is beyond ±0.26 m/s")) == 1


def test_the_description_comes_to_late_subscribers(robot):
    descriptions = robot.watcher.subscribe(String, "/robot_description", LATCHED)
    robot.watcher.until(lambda: descriptions, what="/robot_description")
    assert descriptions[0].data == urdf()


def test_the_map_comes_to_late_subscribers_and_matches_the_world(robot):
    maps = robot.watcher.subscribe(OccupancyGrid, "/map", LATCHED)
    robot.watcher.until(lambda: maps, what="/map")
    grid = maps[0]
    assert grid.header.frame_id == "map"
    cells = np.array(grid.data).reshape(grid.info.height, grid.info.width)
    world = furnished_room()
    assert (cells == world.occupancy(grid.info.resolution)).all()

    def cell(x, y):
        origin = grid.info.origin.position
        row = math.floor((y - origin.y) / grid.info.resolution)
        return cells[row, math.floor((x - origin.x) / grid.info.resolution)]

    assert cell(0, 0) == 0
    assert cell(1.9, 1.75) == 100, "the partition"


def test_initialpose_places_it(robot):
    publisher = robot.watcher.node.create_publisher(PoseWithCovarianceStamped, "/initialpose", 1)
    message = PoseWithCovarianceStamped()
    message.header.frame_id = "map"
    message.pose.pose.position.x = 1.0
    message.pose.pose.position.y = -0.5
    message.pose.pose.orientation = quaternion(1.2)
    robot.until_published_to(publisher, message, lambda: robot.x == 1.0, "the new pose")
    assert robot.y == -0.5
    assert robot.heading == pytest.approx(1.2)


def test_goal_pose_is_driven_to(robot):
    publisher = robot.watcher.node.create_publisher(PoseStamped, "/goal_pose", 1)
    message = PoseStamped()
    message.header.frame_id = "odom"
    message.pose.position.x = 0.3
    message.pose.orientation = quaternion(0.5)
    robot.until_published_to(publisher, message, lambda: robot.speed > 0.05, "motion")
    robot.watcher.until(lambda: robot.logged("goal reached"), what="the goal")
    assert (robot.x, robot.y) == pytest.approx((0.3, 0.0), abs=0.05)
    assert robot.heading == pytest.approx(0.5, abs=0.06)


def test_a_goal_in_an_unknown_frame_is_dismissed(robot):
    publisher = robot.watcher.node.create_publisher(PoseStamped, "/goal_pose", 1)
    message = PoseStamped()
    message.header.frame_id = "moon"
    robot.until_published_to(
        publisher,
        message,
        lambda: robot.logged("goal_pose dismissed: frame 'moon' is neither map nor odom"),
        "the dismissal",
    )


def test_without_motor_power_commands_are_ignored(robot):
    response = robot.watcher.call(SetBool, "/motor_power", SetBool.Request(data=False))
    assert (response.success, response.message) == (True, "motors off")
    robot.watcher.until(
        lambda: robot.logged("the motors are off"), lambda: robot.command(0.2), "the dismissal"
    )
    assert robot.x == 0
    robot.watcher.call(SetBool, "/motor_power", SetBool.Request(data=True))
    robot.watcher.until(lambda: robot.x > 0.02, lambda: robot.command(0.2), "motion")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_with_zero(number):
    with child(SIMULATION.format(options="namespace='solo', camera=False"), number):
        watcher = Watcher("signaller")
        odometry = watcher.subscribe(Odometry, "/solo/odom")
        watcher.until(lambda: odometry, what="/solo/odom")
        topics = dict(watcher.node.get_topic_names_and_types())
        watcher.close()
    assert odometry[-1].header.frame_id == "solo/odom"
    assert not [topic for topic in topics if topic.startswith("/solo/camera")]


def test_commands_with_a_stamp_are_taken_while_they_are_new():
    with child(SIMULATION.format(options="camera=False, twist_stamped=True, namespace='stamped'")):
        watcher = Watcher("stamping")
        odometry = watcher.subscribe(Odometry, "/stamped/odom")
        log = watcher.subscribe(Log, "/rosout", LOG)
        publisher = watcher.node.create_publisher(TwistStamped, "/stamped/cmd_vel", 10)
        command = TwistStamped()
        command.twist.linear.x = 0.2

        def send(age_s):
            stamp = watcher.node.get_clock().now() - Duration(seconds=age_s)
            command.header.stamp = stamp.to_msg()
            publisher.publish(command)

        def x():
            return odometry[-1].pose.pose.position.x if odometry else 0.0

        def logged():
            words = re.compile(r"cmd_vel dismissed: its stamp is [2-9]\d\.\d s old")
            return [entry for entry in log if words.fullmatch(entry.msg)]

        watcher.until(logged, lambda: send(20.0), "the dismissal")
        assert x() == 0
        watcher.until(lambda: x() > 0.02, lambda: send(0.0), "motion")
        driven = x() + 0.2
        command.header.stamp = Time()
        watcher.until(lambda: x() > driven, lambda: publisher.publish(command), "more of it")
        types = dict(watcher.node.get_topic_names_and_types())["/stamped/cmd_vel"]
        watcher.close()
    assert types == ["geometry_msgs/msg/TwistStamped"]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"namespace": "1st robot"}, "namespace '1st robot' is not a ROS namespace"),
        ({"camera_hz": 0}, "camera_hz 0 is not from 0.1 to 60 Hz"),
        ({"camera_hz": 60.1}, "camera_hz 60.1 is not from 0.1 to 60 Hz"),
        ({"camera_hz": math.nan}, "camera_hz nan"),
        ({"seed": -5}, "seed -5 is below 0"),
    ],
)
def test_wrong_options_are_refused_in_words(options, words):
    with pytest.raises(ConfigError, match=words):
        SimOptions(**options)
