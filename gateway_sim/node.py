# SPDX-License-Identifier: Apache-2.0
"""The simulated robot as a ROS node: its topics, services and log."""

import random
import re
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import cv2
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Pose as PoseMessage
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped, Twist, TwistStamped
from nav_msgs.msg import OccupancyGrid, Odometry
from rclpy.context import Context
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import BatteryState, Imu, JointState, LaserScan
from std_msgs.msg import Header, String
from std_srvs.srv import SetBool, Trigger

from gateway.errors import ConfigError
from gateway_sim import lidar, robot_messages
from gateway_sim.any_types import AnyTypes
from gateway_sim.battery import Battery
from gateway_sim.camera_topics import CameraTopics
from gateway_sim.loop import Loop, ros_context, stopped_by_signals
from gateway_sim.navigator import NAVIGATE, Navigator
from gateway_sim.robot import MAX_LINEAR, SILENCE_NS, DismissedError, Event, Robot
from gateway_sim.robot_description import urdf
from gateway_sim.robot_frames import TF_MESSAGE, RobotFrames
from gateway_sim.scenery import Scenery
from gateway_sim.world import Pose, furnished_room

_STATE_NS: Final = 1_000_000_000 // 30  # odometry, transforms, inertia and joints: 30 Hz
_SLOW_NS: Final = 1_000_000_000  # battery and diagnostics: 1 Hz
_DEPTH: Final = 5  # samples kept for a slow reader: a second of the lidar
_COMMAND_DEPTH: Final = 10  # a third of a second of commands at 30 Hz
_SERIES_NS: Final = 10_000_000_000  # commands dismissed closer together are logged once
_MAX_CAMERA_HZ: Final = 60.0  # at 3 ms per picture a fifth of a core
_NAMESPACE: Final = re.compile(r"(/?[A-Za-z_]\w*(/[A-Za-z_]\w*)*)?", re.ASCII)
_WARNINGS: Final = frozenset({Event.HIT, Event.GOAL_BLOCKED, Event.GOAL_POWERLESS, Event.SILENCE})


@dataclass(frozen=True, slots=True)
class SimOptions:
    """The options of the simulated robot.

    Raises:
        ConfigError: a value is out of its range.
    """

    namespace: str = ""  # of the node and its topics, and before its frames
    camera: bool = True
    camera_hz: float = 30.0
    seed: int | None = None  # of slip and noise, another one each time if None
    twist_stamped: bool = False  # cmd_vel is geometry_msgs/msg/TwistStamped, else Twist

    def __post_init__(self) -> None:
        if not _NAMESPACE.fullmatch(self.namespace):
            raise ConfigError(
                f"namespace {self.namespace!r} is not a ROS namespace, such as /robot1"
            )
        if not 0.1 <= self.camera_hz <= _MAX_CAMERA_HZ:
            raise ConfigError(f"camera_hz {self.camera_hz:g} is not from 0.1 to 60 Hz")
        if self.seed is not None and self.seed < 0:
            raise ConfigError(f"seed {self.seed} is below 0")


def run(options: SimOptions) -> int:
    """Run the simulated robot until SIGINT or SIGTERM, and return the exit code 0."""
    stop = threading.Event()
    # Drawing takes 3 ms: more threads would cost more than they save.
    cv2.setNumThreads(1)
    with stopped_by_signals(stop), ros_context() as context:
        robot = SimulatedRobot(context, options)
        try:
            robot.loop.run(stop)
        finally:
            robot.close()
    return 0


class SimulatedRobot:
    """The node ``simulated_robot``. Everything happens on the thread that runs ``loop``.

    It builds messages and draws images only for topics with subscribers. If a package of its types
    is not installed, its transforms and its action come a second after the start.
    """

    def __init__(self, context: Context, options: SimOptions) -> None:
        seed = random.randrange(2**32) if options.seed is None else options.seed  # noqa: S311
        self._options = options
        self._world = furnished_room()
        self._robot = Robot(self._world, time.monotonic_ns(), seed)
        self._lidar = lidar.Lidar(self._world, seed)
        self._battery = Battery()
        self._battery_swaps = 0
        self._node = Node("simulated_robot", context=context, namespace=options.namespace or None)
        self._frames = f"{options.namespace.strip('/')}/" if options.namespace else ""
        self._dismissed_ns: int | None = None  # None after a command was obeyed
        self._types: AnyTypes | None = AnyTypes([TF_MESSAGE, NAVIGATE])
        self.loop = Loop(context)
        self._navigator = Navigator(context, self._node, self._robot, self._in_map)
        self._advertise()
        self._listen()
        self.loop.add_node(self._node)
        self.loop.every(_STATE_NS, self._publish_state)
        self.loop.every(lidar.SCAN_NS, self._publish_scan)
        self.loop.every(_SLOW_NS, self._publish_slowly)
        if options.camera:
            topics = CameraTopics(self._node, self._world)
            period_ns = round(1e9 / options.camera_hz)
            self.loop.every(period_ns, lambda: self._publish_camera(topics))
        self._node.get_logger().info(f"ready at the origin, seed {seed}")

    def close(self) -> None:
        """Take the node off the graph."""
        if self._types is not None:
            self._types.close()
        self._navigator.close()
        self.loop.close()
        self._node.destroy_node()

    def _advertise(self) -> None:
        def publisher(message_type: type, topic: str) -> Publisher:
            # Reliable, as Gazebo's sensors are: it matches every subscription.
            return self._node.create_publisher(message_type, topic, _DEPTH)

        self._odometry = publisher(Odometry, "odom")
        self._imu = publisher(Imu, "imu")
        self._joints = publisher(JointState, "joint_states")
        self._scan = publisher(LaserScan, "scan")
        self._battery_state = publisher(BatteryState, "battery_state")
        self._diagnostics = publisher(DiagnosticArray, "diagnostics")
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self._map = self._node.create_publisher(OccupancyGrid, "map", latched)
        self._map.publish(robot_messages.occupancy_grid(self._header("map"), self._world))
        self._description = self._node.create_publisher(String, "robot_description", latched)
        self._description.publish(String(data=urdf()))
        self._transforms = RobotFrames(self._node, self._frames)
        self._scenery = Scenery(self._node, self._world)

    def _listen(self) -> None:
        node = self._node
        if self._options.twist_stamped:
            node.create_subscription(TwistStamped, "cmd_vel", self._on_stamped, _COMMAND_DEPTH)
        else:
            node.create_subscription(Twist, "cmd_vel", self._on_command, _COMMAND_DEPTH)
        node.create_subscription(
            PoseWithCovarianceStamped, "initialpose", self._on_initial_pose, _COMMAND_DEPTH
        )
        node.create_subscription(PoseStamped, "goal_pose", self._on_goal, _COMMAND_DEPTH)
        node.create_service(Trigger, "reset", self._on_reset)
        node.create_service(SetBool, "motor_power", self._on_motor_power)

    def _on_stamped(self, message: TwistStamped) -> None:
        self._on_command(message.twist, message.header.stamp)

    def _on_command(self, message: Twist, stamp: Time | None = None) -> None:
        self._step()
        try:
            self._require_fresh(stamp)
            self._robot.command(message.linear.x, message.angular.z)
        except DismissedError as error:
            now_ns = time.monotonic_ns()
            if self._dismissed_ns is None or now_ns - self._dismissed_ns > _SERIES_NS:
                self._node.get_logger().warning(f"cmd_vel dismissed: {error}")
            self._dismissed_ns = now_ns
        else:
            self._dismissed_ns = None

    def _require_fresh(self, stamp: Time | None) -> None:
        """Dismiss a command that is older than it would hold. One without a stamp is new."""
        if stamp is None or (stamp.sec, stamp.nanosec) == (0, 0):
            return
        now_ns = self._node.get_clock().now().nanoseconds
        age_ns = now_ns - (stamp.sec * 1_000_000_000 + stamp.nanosec)
        if age_ns > SILENCE_NS:
            raise DismissedError(f"its stamp is {age_ns / 1e9:.1f} s old")

    def _on_initial_pose(self, message: PoseWithCovarianceStamped) -> None:
        self._obey("initialpose", message.header, message.pose.pose, self._robot.place)

    def _on_goal(self, message: PoseStamped) -> None:
        self._obey("goal_pose", message.header, message.pose, self._robot.drive_to)

    def _obey(
        self, topic: str, header: Header, pose: PoseMessage, act: Callable[[Pose], None]
    ) -> None:
        self._step()
        wanted = Pose(pose.position.x, pose.position.y, robot_messages.heading(pose.orientation))
        try:
            target = self._in_map(header.frame_id, wanted)
            act(target)
        except DismissedError as error:
            self._node.get_logger().warning(f"{topic} dismissed: {error}")
        else:
            self._node.get_logger().info(f"{topic} x {target.x:.2f}, y {target.y:.2f} m obeyed")

    def _in_map(self, frame_id: str, pose: Pose) -> Pose:
        match frame_id.removeprefix("/").removeprefix(self._frames):
            case "" | "map":
                return pose
            case "odom":
                return self._robot.from_odometry(pose)
            case _:
                raise DismissedError(f"frame {frame_id!r} is neither map nor odom")

    def _on_reset(self, _request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._step()
        self._robot.reset()
        self._node.get_logger().info("back at the start")
        response.success = True
        response.message = "back at the start"
        return response

    def _on_motor_power(
        self, request: SetBool.Request, response: SetBool.Response
    ) -> SetBool.Response:
        self._step()
        self._robot.switch_motors(request.data)
        self._dismissed_ns = None  # from now on commands are dismissed for another reason
        response.success = True
        response.message = f"motors {'on' if request.data else 'off'}"
        self._node.get_logger().info(response.message)
        return response

    def _publish_state(self) -> None:
        self._step()
        if self._types is not None and self._types.poll():
            self._transforms.open(self._types, self._stamp())
            self._navigator.open(self._types)
            self._types = None
        self._navigator.poll(f"{self._frames}map")
        robot, stamp = self._robot, self._stamp()
        child = f"{self._frames}base_footprint"
        odom = self._header("odom", stamp)
        robot_messages.offer(self._odometry, lambda: robot_messages.odometry(odom, child, robot))
        base = self._header("base_link", stamp)
        robot_messages.offer(self._joints, lambda: robot_messages.joint_state(base, robot))
        robot_messages.offer(
            self._imu, lambda: robot_messages.imu(self._header("imu_link", stamp), robot)
        )
        self._transforms.publish(stamp, robot)

    def _publish_scan(self) -> None:
        robot_messages.offer(
            self._scan,
            lambda: robot_messages.laser_scan(
                self._header("base_scan"), self._lidar.scan(self._robot.pose)
            ),
        )

        self._scenery.publish_points(self._header("base_scan"), self._robot)
        self._scenery.publish_way(self._header("map"), self._robot)

    def _publish_camera(self, topics: CameraTopics) -> None:
        self._step()
        topics.publish(self._header("camera_rgb_optical_frame"), self._robot.pose)

    def _publish_slowly(self) -> None:
        battery = self._battery
        effort = abs(self._robot.linear) / MAX_LINEAR
        battery.step(_SLOW_NS / 1e9, effort, self._robot.parked)
        if battery.swaps > self._battery_swaps:
            self._battery_swaps = battery.swaps
            self._node.get_logger().warning("battery low, swapped for a full one")
        robot_messages.offer(
            self._battery_state,
            lambda: robot_messages.battery_state(self._header("base_link"), battery),
        )
        robot_messages.offer(self._diagnostics, self._diagnosis)
        self._scenery.publish_markers(self._header("map"))

    def _diagnosis(self) -> DiagnosticArray:
        robot, battery = self._robot, self._battery
        on = robot.motors_on
        statuses = [
            robot_messages.diagnostic(
                "motors", "on" if on else "off", on, {"linear": robot.linear, "goal": robot.goal}
            ),
            robot_messages.diagnostic(
                "battery",
                "charging" if battery.charging else "discharging",
                battery.percentage > 0.2,
                {"percentage": round(100 * battery.percentage, 1)},
            ),
            robot_messages.diagnostic("lidar", "turning", True, {"beams": lidar.BEAMS}),
        ]
        if self._options.camera:
            rate = {"rate_hz": self._options.camera_hz}
            statuses.append(robot_messages.diagnostic("camera", "looking", True, rate))
        return DiagnosticArray(header=self._header(""), status=statuses)

    def _step(self) -> None:
        self._robot.step(time.monotonic_ns())
        for event in self._robot.take_events():
            log = self._node.get_logger()
            # rclpy ties a severity to the line that logs
            if event in _WARNINGS:
                log.warning(event.value)
            else:
                log.info(event.value)

    def _stamp(self) -> Time:
        return self._node.get_clock().now().to_msg()

    def _header(self, frame: str, stamp: Time | None = None) -> Header:
        frame_id = f"{self._frames}{frame}" if frame else ""
        return Header(stamp=stamp or self._stamp(), frame_id=frame_id)
