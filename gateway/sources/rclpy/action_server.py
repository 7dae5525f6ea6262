# SPDX-License-Identifier: Apache-2.0
"""Actions that the gateway provides, by rclpy."""

import contextlib
from collections.abc import Callable, Iterable
from typing import Any, Final

from rclpy.qos import QoSProfile, qos_profile_action_status_default

from gateway.sources.action_server import HeldGoal, ServedAction
from gateway.sources.actions import GoalRequest
from gateway.sources.goal_ids import with_goal_id
from gateway.sources.rclpy.action_forms import ActionForm
from gateway.sources.rclpy.creating import create_publisher
from gateway.sources.rclpy.errors import refusals
from gateway.sources.rclpy.interfaces import message_class, service_class
from gateway.sources.rclpy.rclpy_private.handles import raw_publisher
from gateway.sources.rclpy.ready_events import Endpoints
from gateway.sources.rclpy.replier import OnRequest, Replier

_FEEDBACK_PROFILE: Final = QoSProfile(depth=10)  # of rcl_action: reliable, volatile


class RclpyActionServer(ServedAction):
    """An action that the gateway provides."""

    def __init__(
        self,
        endpoints: Endpoints,
        now_ns: Callable[[], int],
        name: str,
        form: ActionForm,
        on_goal: Callable[[GoalRequest], None],
        on_cancel: Callable[[GoalRequest], None],
        on_close: Callable[[Any], None],
    ) -> None:
        super().__init__(endpoints.loop, now_ns, name, form, on_goal, on_cancel, on_close)
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

    def _to_result_response(self, status: int, result: bytes | None = None) -> Any:
        with refusals(self._subject):
            return super()._to_result_response(status, result)

    def _read_cancel(self, message: Any) -> tuple[bytes, int]:
        stamp = message.goal_info.stamp
        return bytes(message.goal_info.goal_id.uuid), stamp.sec * 10**9 + stamp.nanosec

    def _to_cancel_response(self, code: int, goals: Iterable[HeldGoal]) -> Any:
        response = self._cancel_response(return_code=code)
        response.goals_canceling = [self._info_of(goal) for goal in goals]
        return response

    def _publish_statuses(self, goals: Iterable[HeldGoal]) -> None:
        message: Any = self._statuses()
        message.status_list = [
            self._status(goal_info=self._info_of(goal), status=goal.status) for goal in goals
        ]
        with refusals(self._subject):
            self._status_topic.publish(message)

    def _destroy_parts(self) -> None:
        self._undo.close()

    def _info_of(self, goal: HeldGoal) -> Any:
        info: Any = self._info()
        info.goal_id.uuid = list(goal.goal_id)
        info.stamp.sec, info.stamp.nanosec = divmod(goal.accepted_ns, 10**9)
        return info
