# SPDX-License-Identifier: Apache-2.0
"""Actions that the gateway provides: three services and two topics each, by ROS 2's design.

https://design.ros2.org/articles/actions.html
"""

import asyncio
import contextlib
from collections.abc import Callable
from typing import Any, Final

from rclpy.qos import QoSProfile, qos_profile_action_status_default

from gateway.sources.actions import ABORTED, CANCELED, GoalOutcome, GoalRequest
from gateway.sources.rclpy.action_forms import ActionForm
from gateway.sources.rclpy.creating import create_publisher
from gateway.sources.rclpy.errors import refusals
from gateway.sources.rclpy.goal_ids import with_goal_id
from gateway.sources.rclpy.interfaces import message_class, service_class
from gateway.sources.rclpy.rclpy_private.handles import raw_publisher
from gateway.sources.rclpy.ready_events import Endpoints
from gateway.sources.rclpy.replier import OnRequest, Replier, Reply

# A person with a headset supervises a few. More, as of a client that floods, are rejected.
MAX_GOALS: Final = 64
# As rclpy's servers do: some clients ask for the result only when a person wants to see it.
RESULT_KEPT_S: Final = 900.0
# of results: at 1 MB each, 64 MB for one action at worst
MAX_RESULTS_KEPT: Final = 64
# for one goal's result: its client, and tools that watch
MAX_WAITING: Final = 16

_FEEDBACK_PROFILE: Final = QoSProfile(depth=10)  # of rcl_action: reliable, volatile

# action_msgs/msg/GoalStatus
_UNKNOWN: Final = 0
_EXECUTING: Final = 2
_CANCELING: Final = 3

# action_msgs/srv/CancelGoal
_NONE: Final = 0
_UNKNOWN_GOAL_ID: Final = 2
_GOAL_TERMINATED: Final = 3

_NO_ID: Final = bytes(16)


class RclpyGoalRequest:
    """A goal that a client has sent, and what the server knows of it."""

    def __init__(
        self, server: "RclpyActionServer", status: Any, accepted_ns: int, cdr: bytes
    ) -> None:
        self.cdr = cdr
        self.goal_id = bytes(status.goal_info.goal_id.uuid)
        self.accepted_ns = accepted_ns
        self.status: Any = status  # action_msgs/msg/GoalStatus
        self.response: Any = None  # once it has ended
        self.waiting: list[Reply] = []
        self.expiry: asyncio.TimerHandle | None = None
        self._server = server

    @property
    def is_open(self) -> bool:
        """True until the goal has ended."""
        return self.response is None

    def feedback(self, cdr: bytes) -> None:
        """Publish the action's Feedback."""
        if self.is_open:
            self._server.publish_feedback(self.goal_id, cdr)

    def finish(self, status: GoalOutcome, result: bytes) -> None:
        """End the goal. See the port."""
        if self.is_open:
            is_possible = status != CANCELED or self.status.status == _CANCELING
            self._server.finish(self, status if is_possible else ABORTED, result)

    def answer_waiting(self) -> None:
        """Send the result to those who wait for it."""
        for reply in self.waiting:
            reply(self.response)
        self.waiting.clear()


class RclpyActionServer:
    """An action that the gateway provides.

    A goal is executing from its acceptance on. It may come to be canceling. It ends as succeeded,
    canceled or aborted, and is then kept for those who ask for its result late.
    """

    def __init__(
        self,
        endpoints: Endpoints,
        now_ns: Callable[[], int],
        name: str,
        form: ActionForm,
        on_goal: Callable[[GoalRequest], None],
        on_cancel: Callable[[GoalRequest], None],
        on_close: Callable[["RclpyActionServer"], None],
    ) -> None:
        self.name = name
        self.type_name = form.type_name
        self._loop = endpoints.loop
        self._now_ns = now_ns
        self._on_goal = on_goal
        self._on_cancel = on_cancel
        self._on_close = on_close
        self._subject = f"action {name}"
        self._is_closing = False
        self._goals: dict[bytes, RclpyGoalRequest] = {}
        self._ended: dict[bytes, RclpyGoalRequest] = {}  # those of them, the oldest first
        self._form = form
        cancel_class = service_class("action_msgs/srv/CancelGoal")
        self._cancel_response = cancel_class.Response
        self._statuses = message_class("action_msgs/msg/GoalStatusArray")
        self._status = message_class("action_msgs/msg/GoalStatus")
        self._info = message_class("action_msgs/msg/GoalInfo")
        with contextlib.ExitStack() as undo:

            def publisher(part: str, part_class: Any, profile: QoSProfile) -> Any:
                topic = f"{name}/_action/{part}"
                opened = create_publisher(endpoints.node, self._subject, topic, part_class, profile)
                undo.callback(endpoints.node.destroy_publisher, opened)
                return opened

            feedback = publisher("feedback", form.feedback, _FEEDBACK_PROFILE)
            self._publish_feedback = raw_publisher(feedback)
            self._status_topic = publisher(
                "status", self._statuses, qos_profile_action_status_default
            )
            # The service that clients use first is created last: a client that sees it finds the
            # rest.
            services: list[tuple[str, Any, OnRequest]] = [
                ("get_result", form.get_result, self._answer_result),
                ("cancel_goal", cancel_class, self._cancel),
                ("send_goal", form.send_goal, self._accept),
            ]
            self._repliers: list[Replier] = []
            for part, part_class, on_request in services:
                full_name = f"{name}/_action/{part}"
                replier = Replier(
                    endpoints, part_class, full_name, on_request, subject=self._subject
                )
                undo.callback(replier.close)
                self._repliers.append(replier)
            self._undo = undo.pop_all()

    def publish_feedback(self, goal_id: bytes, cdr: bytes) -> None:
        """Publish the Feedback of a goal."""
        with refusals(self._subject):
            self._publish_feedback(with_goal_id(goal_id, cdr))

    def finish(self, goal: RclpyGoalRequest, status: int, result: bytes) -> None:
        """End a goal that has not ended."""
        with refusals(self._subject):
            response = self._form.to_result_response(status, result)
        self._settle(goal, status, response)
        self._publish_status()
        goal.answer_waiting()

    def close(self) -> None:
        """Abort what has not ended and withdraw the action. Closing twice is harmless."""
        if self._is_closing:
            return
        self._is_closing = True
        try:
            unfinished = [goal for goal in self._goals.values() if goal.is_open]
            for goal in unfinished:
                self._settle(goal, ABORTED, self._form.to_result_response(ABORTED))
            if unfinished:
                self._publish_status()  # once: it holds all goals
            for goal in unfinished:
                goal.answer_waiting()
            for replier in self._repliers:
                replier.drain()  # goals that have just arrived are rejected, the rest answered
        finally:
            self._on_close(self)

    @property
    def has_answered(self) -> bool:
        """True once a response has been sent."""
        return any(replier.has_replied for replier in self._repliers)

    def destroy(self) -> None:
        """Destroy it, at the latest once its last response has been delivered."""
        for goal in self._ended.values():
            if goal.expiry is not None:
                goal.expiry.cancel()
        self._undo.close()

    def _accept(self, message: Any, reply: Reply) -> None:
        goal_id, cdr = self._form.read_goal_request(message)
        is_malformed = len(goal_id) != len(_NO_ID)
        running = len(self._goals) - len(self._ended)
        if self._is_closing or is_malformed or goal_id in self._goals or running >= MAX_GOALS:
            reply(self._form.to_goal_response(None))
            return
        now_ns = self._now_ns()
        info = self._info()
        info.goal_id.uuid = list(goal_id)
        info.stamp.sec, info.stamp.nanosec = divmod(now_ns, 10**9)
        reply(self._form.to_goal_response(now_ns))
        status = self._status(goal_info=info, status=_EXECUTING)
        goal = RclpyGoalRequest(self, status, now_ns, cdr)
        self._goals[goal_id] = goal
        self._publish_status()
        self._on_goal(goal)

    def _cancel(self, message: Any, reply: Reply) -> None:
        goal_id = bytes(message.goal_info.goal_id.uuid)
        stamp = message.goal_info.stamp
        until_ns = stamp.sec * 10**9 + stamp.nanosec
        wanted = self._to_cancel(goal_id, until_ns)
        response = self._cancel_response()
        response.return_code = _NONE
        if goal_id != _NO_ID and not until_ns and not wanted:
            response.return_code = _GOAL_TERMINATED if goal_id in self._goals else _UNKNOWN_GOAL_ID
        response.goals_canceling = [goal.status.goal_info for goal in wanted]
        reply(response)
        for goal in wanted:
            goal.status.status = _CANCELING
        if wanted:
            self._publish_status()
        for goal in wanted:
            if goal.is_open:  # an earlier callback may have ended it, or closed the action
                self._on_cancel(goal)

    def _to_cancel(self, goal_id: bytes, until_ns: int) -> list[RclpyGoalRequest]:
        """Return the goals that a request of action_msgs/srv/CancelGoal selects.

        That is a goal by its id, those accepted until a stamp, both, or with neither all of them.
        Never those that are canceling already.
        """
        wants_all = goal_id == _NO_ID and not until_ns
        return [
            goal
            for goal in self._goals.values()
            if goal.is_open
            and goal.status.status == _EXECUTING
            and (
                wants_all
                or goal.goal_id == goal_id
                or (until_ns > 0 and goal.accepted_ns <= until_ns)
            )
        ]

    def _answer_result(self, message: Any, reply: Reply) -> None:
        goal = self._goals.get(self._form.read_result_request(message))
        if goal is None:
            reply(self._form.to_result_response(_UNKNOWN))
        elif not goal.is_open:
            reply(goal.response)
        elif len(goal.waiting) < MAX_WAITING:
            goal.waiting.append(reply)
        else:  # those who have waited longer keep their places
            reply(self._form.to_result_response(_UNKNOWN))

    def _settle(self, goal: RclpyGoalRequest, status: int, response: Any) -> None:
        goal.status.status = status
        goal.response = response
        self._ended[goal.goal_id] = goal
        goal.expiry = self._loop.call_later(RESULT_KEPT_S, self._forget, goal)
        if len(self._ended) > MAX_RESULTS_KEPT:
            self._forget(next(iter(self._ended.values())))

    def _forget(self, goal: RclpyGoalRequest) -> None:
        if goal.expiry is not None:
            goal.expiry.cancel()
        del self._goals[goal.goal_id], self._ended[goal.goal_id]

    def _publish_status(self) -> None:
        message: Any = self._statuses()
        message.status_list = [goal.status for goal in self._goals.values()]
        with refusals(self._subject):
            self._status_topic.publish(message)
