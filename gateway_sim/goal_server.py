# SPDX-License-Identifier: Apache-2.0
"""An action with one goal at a time: three services and two topics, by ROS 2's design.

https://design.ros2.org/articles/actions.html. rclpy's own action server needs the action's package,
and its services cannot answer later on the EventsExecutor. So the services are on a node that
nothing spins, and are asked for requests.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Final

from action_msgs.msg import GoalInfo, GoalStatus, GoalStatusArray
from action_msgs.srv import CancelGoal
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile, qos_profile_action_status_default

from gateway.sources.goal_ids import with_goal_id
from gateway.sources.rclpy import fast_dds
from gateway.sources.rclpy.rclpy_private.handles import request_taker, response_sender
from gateway_sim.any_types import AnyAction

MAX_KEPT: Final = 16  # the newest goals that have ended, for clients that ask for a result late
MAX_WAITING: Final = 16  # requests for one goal's result
_SERVICE_DEPTH: Final = 2 * MAX_WAITING  # the results of one goal are sent in one burst
_REQUESTS_A_TURN: Final = 10  # of each service, so that the robot's own work goes on
_FEEDBACK_DEPTH: Final = 10  # of rcl_action
_LAST_STATUS: Final = Duration(seconds=1)  # a reader may be frozen
_NO_ID: Final = bytes(16)

Values = Mapping[str, Any]
# Begins a goal, or raises a ValueError that says why it is rejected.
Begin = Callable[[Values], None]
_Reply = Callable[[Any], None]


@dataclass(slots=True)
class _Goal:
    status: GoalStatus
    response: Any = None  # once it has ended
    waiting: list[_Reply] = field(default_factory=list)

    @property
    def goal_id(self) -> bytes:
        return bytes(self.status.goal_info.goal_id.uuid)


class GoalServer:
    """Serves an action. A goal that is accepted aborts the one before.

    Everything happens within its methods, on the caller's thread.
    """

    def __init__(
        self,
        context: Context,
        node: Node,
        name: str,
        action: AnyAction,
        begin: Begin,
        preempted: Values,
    ) -> None:
        """Serve it in the namespace of *node*, which does the logging, by another node.

        *preempted* is the result of a goal that a newer one has ended.
        """
        self._action = action
        self._begin = begin
        self._preempted = preempted
        self._log = node.get_logger()
        self._name = name
        self._clock = node.get_clock()
        self._node = Node(
            f"{node.get_name()}_{name}",
            context=context,
            namespace=node.get_namespace(),
            # nothing would answer these services
            start_parameter_services=False,
            parameter_overrides=[Parameter("start_type_description_service", value=False)],
            enable_rosout=False,
        )
        self._current: _Goal | None = None
        self._ended: dict[bytes, _Goal] = {}  # oldest first
        form = action.form
        part = f"{name}/_action/"
        self._feedback = self._node.create_publisher(
            form.feedback, f"{part}feedback", _FEEDBACK_DEPTH
        )
        fast_dds.forget_error()
        self._status = self._node.create_publisher(
            GoalStatusArray, f"{part}status", qos_profile_action_status_default
        )
        # The service that clients use first is created last: a client that sees it finds the rest.
        self._services = (
            self._serve(form.get_result, f"{part}get_result", self._answer_result),
            self._serve(CancelGoal, f"{part}cancel_goal", self._cancel),
            self._serve(form.send_goal, f"{part}send_goal", self._accept),
        )

    @property
    def is_executing(self) -> bool:
        """True while there is a goal."""
        return self._current is not None

    @property
    def is_canceling(self) -> bool:
        """True while there is a goal whose client asked for its end."""
        return (
            self._current is not None and self._current.status.status == GoalStatus.STATUS_CANCELING
        )

    def poll(self) -> None:
        """Answer the requests that have come."""
        for take in reversed(self._services):  # goals first: the others are about them
            for _ in range(_REQUESTS_A_TURN):
                if not take():
                    break

    def feed_back(self, values: Values) -> None:
        """Publish the goal's feedback."""
        if self._current is not None:
            cdr = self._action.write_feedback(values)
            self._feedback.publish(with_goal_id(self._current.goal_id, cdr))

    def finish(self, status: int, result: Values) -> None:
        """End the goal as ``SUCCEEDED``, ``CANCELED`` or ``ABORTED`` of action_msgs/GoalStatus."""
        goal, self._current = self._current, None
        if goal is None:
            return
        goal.status.status = status
        goal.response = self._action.form.to_result_response(
            status, self._action.write_result(result)
        )
        self._ended[goal.goal_id] = goal
        if len(self._ended) > MAX_KEPT:
            del self._ended[next(iter(self._ended))]
        self._publish_status()
        for reply in goal.waiting:
            reply(goal.response)

    def close(self) -> None:
        """Take the action off the graph, once readers of its status know how the goals ended."""
        self._status.wait_for_all_acked(_LAST_STATUS)
        self._node.destroy_node()

    def _serve(
        self, service_class: Any, name: str, answer: Callable[[Any, _Reply], None]
    ) -> Callable[[], bool]:
        """Open a service, and return a function that answers one request, if there is one."""
        service = self._node.create_service(
            service_class, name, lambda *_: None, qos_profile=QoSProfile(depth=_SERVICE_DEPTH)
        )
        fast_dds.forget_error()
        take = request_taker(service)
        send = response_sender(service)

        def take_one() -> bool:
            request, info = take(service_class.Request)
            if info is None:
                return False
            answer(request, lambda response: send(response, info.request_id))
            return True

        return take_one

    def _accept(self, request: Any, reply: _Reply) -> None:
        form = self._action.form
        goal_id, cdr = form.read_goal_request(request)
        try:
            self._require_new(goal_id)
            self._begin(self._action.read_goal(cdr))
        except ValueError as error:  # also for CDR that cannot be read
            self._log.warning(f"{self._name} goal rejected: {error}")
            reply(form.to_goal_response(None))
            return
        self.finish(GoalStatus.STATUS_ABORTED, self._preempted)
        now = self._clock.now()
        info = GoalInfo(stamp=now.to_msg())
        info.goal_id.uuid = list(goal_id)
        self._current = _Goal(GoalStatus(goal_info=info, status=GoalStatus.STATUS_EXECUTING))
        reply(form.to_goal_response(now.nanoseconds))
        self._publish_status()

    def _require_new(self, goal_id: bytes) -> None:
        if len(goal_id) != len(_NO_ID):
            raise ValueError("it has no id")
        known = goal_id in self._ended
        if known or (self._current is not None and self._current.goal_id == goal_id):
            raise ValueError("another goal has its id")

    def _cancel(self, request: CancelGoal.Request, reply: _Reply) -> None:
        """Cancel the goal if its id, the time before which it was accepted, or nothing is given."""
        goal_id = bytes(request.goal_info.goal_id.uuid)
        until = _nanoseconds(request.goal_info.stamp)
        response = CancelGoal.Response()
        goal = self._current
        if goal is not None and _selects(goal, goal_id, until):
            if not self.is_canceling:
                goal.status.status = GoalStatus.STATUS_CANCELING
                response.goals_canceling = [goal.status.goal_info]
        elif goal_id in self._ended:
            response.return_code = CancelGoal.Response.ERROR_GOAL_TERMINATED
        elif goal_id != _NO_ID and not until:
            response.return_code = CancelGoal.Response.ERROR_UNKNOWN_GOAL_ID
        reply(response)
        if response.goals_canceling:
            self._publish_status()

    def _answer_result(self, request: Any, reply: _Reply) -> None:
        goal_id = self._action.form.read_result_request(request)
        goal = self._current
        if goal_id in self._ended:
            reply(self._ended[goal_id].response)
        elif goal is None or goal.goal_id != goal_id or len(goal.waiting) >= MAX_WAITING:
            reply(self._action.form.to_result_response(GoalStatus.STATUS_UNKNOWN))
        else:
            goal.waiting.append(reply)

    def _publish_status(self) -> None:
        current = [] if self._current is None else [self._current]
        goals = [*self._ended.values(), *current]
        self._status.publish(GoalStatusArray(status_list=[goal.status for goal in goals]))


def _selects(goal: _Goal, goal_id: bytes, until_ns: int) -> bool:
    if until_ns and _nanoseconds(goal.status.goal_info.stamp) <= until_ns:
        return True
    return goal.goal_id == goal_id or (goal_id == _NO_ID and not until_ns)


def _nanoseconds(stamp: Any) -> int:
    return int(stamp.sec * 10**9 + stamp.nanosec)
