# SPDX-License-Identifier: Apache-2.0
"""The action ``navigate_to_pose`` of the simulated robot, as Nav2 has it.

The goal is of nav2_msgs/action/NavigateToPose. It is aborted by a newer goal, also on
``goal_pose``, by a command from another client, and by everything else that stops the robot.
"""

import time
from collections.abc import Callable
from typing import Any, Final

from action_msgs.msg import GoalStatus
from geometry_msgs.msg import Quaternion
from rclpy.context import Context
from rclpy.node import Node

from gateway_sim.any_types import AnyTypes, MissingTypeError
from gateway_sim.goal_server import GoalServer, Values
from gateway_sim.robot import GOAL_SPEED, Event, Robot
from gateway_sim.robot_messages import heading, quaternion
from gateway_sim.world import Pose

NAVIGATE: Final = "nav2_msgs/action/NavigateToPose"
_NAME: Final = "navigate_to_pose"
_FEEDBACK_NS: Final = 250_000_000  # four times a second, for a person who watches
_BRAKING_NS: Final = 1_000_000_000  # four times what it takes from full speed
# Nav2 passes on the codes of its parts: UNKNOWN and FAILED_TO_MAKE_PROGRESS are FollowPath's.
_UNKNOWN: Final = 100
_BLOCKED: Final = 105
_PREEMPTED: Final = {"error_code": _UNKNOWN, "error_msg": Event.GOAL_REPLACED.value}

# Returns the pose on the map for one in a frame, or raises a DismissedError.
InMap = Callable[[str, Pose], Pose]


class Navigator:
    """Serves the action once its types are there. Without them, it logs that once."""

    def __init__(self, context: Context, node: Node, robot: Robot, in_map: InMap) -> None:
        self._context = context
        self._node = node
        self._robot = robot
        self._in_map = in_map
        self._server: GoalServer | None = None
        self._target: Pose | None = None
        self._begun_ns = 0
        self._fed_back_ns = 0
        self._canceled_ns = 0

    def open(self, types: AnyTypes) -> None:
        """Begin to serve."""
        try:
            action = types.action(NAVIGATE)
        except MissingTypeError as error:
            self._node.get_logger().warning(f"no action {_NAME}: {error}")
            return
        self._server = GoalServer(self._context, self._node, _NAME, action, self._begin, _PREEMPTED)

    def poll(self, map_frame: str) -> None:
        """Take requests, and report how far the robot is. Call it about ten times a second."""
        server = self._server
        if server is None:
            return
        self._end_what_has_ended(server)  # before a newer goal could be taken for its cause
        server.poll()
        if server.is_canceling and self._robot.goal is self._target:
            self._robot.cancel_goal()
            self._canceled_ns = time.monotonic_ns()
        if server.is_executing and not server.is_canceling:
            self._feed_back(server, map_frame)

    def close(self) -> None:
        """Abort the goal, and take the action off the graph."""
        server, self._server = self._server, None
        if server is not None:
            self._finish(server, GoalStatus.STATUS_ABORTED, _UNKNOWN, "the robot is leaving")
            server.close()

    def _begin(self, goal: Values) -> None:
        """Drive to a goal.

        Raises:
            DismissedError: the robot cannot.
        """
        pose, header = goal["pose"]["pose"], goal["pose"]["header"]
        place, turn = pose["position"], Quaternion(**pose["orientation"])
        target = self._in_map(header["frame_id"], Pose(place["x"], place["y"], heading(turn)))
        self._robot.drive_to(target)
        self._target = target
        self._begun_ns = time.monotonic_ns()
        self._fed_back_ns = 0
        where = f"x {target.x:.2f}, y {target.y:.2f} m"
        self._node.get_logger().info(f"{_NAME} {where} accepted")

    def _end_what_has_ended(self, server: GoalServer) -> None:
        robot = self._robot
        if not server.is_executing or robot.goal is self._target:
            return
        why = Event.GOAL_REPLACED if robot.goal is not None else robot.goal_end
        if why == Event.GOAL_REACHED:
            self._finish(server, GoalStatus.STATUS_SUCCEEDED, 0, "")
        elif why != Event.GOAL_CANCELED:
            code = _BLOCKED if why == Event.GOAL_BLOCKED else _UNKNOWN
            self._finish(server, GoalStatus.STATUS_ABORTED, code, why.value if why else "")
        elif self._has_braked():
            self._finish(server, GoalStatus.STATUS_CANCELED, 0, "")

    def _has_braked(self) -> bool:
        """Return whether the robot stands after a cancellation, unless another client drives it."""
        waited_ns = time.monotonic_ns() - self._canceled_ns
        return self._robot.linear == self._robot.angular == 0.0 or waited_ns > _BRAKING_NS

    def _finish(self, server: GoalServer, status: int, code: int, text: str) -> None:
        server.finish(status, {"error_code": code, "error_msg": text})

    def _feed_back(self, server: GoalServer, map_frame: str) -> None:
        now_ns = time.monotonic_ns()
        if now_ns - self._fed_back_ns < _FEEDBACK_NS:
            return
        self._fed_back_ns = now_ns
        pose, left = self._robot.pose, self._robot.distance_left
        rotation = quaternion(pose.heading)
        stamp = self._node.get_clock().now().nanoseconds
        server.feed_back(
            {
                "current_pose": {
                    "header": {"stamp": _parts(stamp), "frame_id": map_frame},
                    "pose": {
                        "position": {"x": pose.x, "y": pose.y},
                        "orientation": {"z": rotation.z, "w": rotation.w},
                    },
                },
                "navigation_time": _parts(now_ns - self._begun_ns),
                "estimated_time_remaining": _parts(round(left / GOAL_SPEED * 1e9)),
                "number_of_recoveries": 0,
                "distance_remaining": left,
            }
        )


def _parts(nanoseconds: int) -> dict[str, Any]:
    """Return the values of a Time or a Duration of builtin_interfaces."""
    return dict(zip(("sec", "nanosec"), divmod(nanoseconds, 10**9), strict=True))
