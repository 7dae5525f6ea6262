# SPDX-License-Identifier: Apache-2.0
"""Actions that the gateway uses, by rclpy."""

import contextlib
from collections.abc import Callable
from typing import Any, Final

from rclpy.qos import QoSProfile

from gateway.config.limits import MAX_QUEUE_DEPTH
from gateway.sources.action_client import GoalClient
from gateway.sources.rclpy.action_forms import ActionForm
from gateway.sources.rclpy.errors import refusals, remapped
from gateway.sources.rclpy.interfaces import service_class
from gateway.sources.rclpy.ready_events import Endpoints
from gateway.sources.rclpy.requester import RclpyRequester
from gateway.sources.rclpy.samples import Samples
from gateway.sources.requester import FindConflict

# One reader gets the feedback of all goals of an action, and the loop may be busy at the time.
_READER_PROFILE: Final = QoSProfile(depth=MAX_QUEUE_DEPTH)


class RclpyActionClient(GoalClient):
    """A client of an action."""

    def __init__(
        self,
        endpoints: Endpoints,
        samples: Samples,
        name: str,
        form: ActionForm,
        on_close: Callable[[Any], None],
        *,
        is_paced: Callable[[], bool],
        find_conflict: FindConflict,
    ) -> None:
        super().__init__(endpoints.loop, name, form, on_close)
        self._node = endpoints.node
        with contextlib.ExitStack() as undo:

            def requester(part_class: Any, part: str, **options: Any) -> RclpyRequester:
                full_name = f"{name}/_action/{part}"
                opened = RclpyRequester(
                    endpoints, part_class, full_name, subject=self._subject, **options
                )
                undo.callback(opened.close)
                return opened

            # First: DDS announces readers in order, and a server accepts a goal only once it knows
            # the reader for its answer. By then it also knows this one, whose first sample might
            # be lost otherwise.
            with refusals(self._subject):
                self._feedback = samples.read(
                    form.feedback,
                    self._feedback_topic,
                    _READER_PROFILE,
                    self._deliver_feedback,
                )
            undo.callback(self._feedback.close)
            if self._feedback.topic_name != self._feedback_topic:
                raise remapped(self._subject, self._feedback.topic_name)
            # Not paced: these are under way as long as their goals, and sent as those are accepted.
            self._results = requester(form.get_result, "get_result", is_paced=lambda: False)
            self._cancels = requester(
                service_class("action_msgs/srv/CancelGoal"), "cancel_goal", is_paced=is_paced
            )
            self._goals = requester(
                form.send_goal,
                "send_goal",
                is_ready=self._is_rest_ready,
                is_paced=is_paced,
                find_conflict=find_conflict,
            )
            self._undo = undo.pop_all()

    def _to_request(self, goal_id: bytes, goal: bytes) -> Any:
        with refusals(self._subject):
            return super()._to_request(goal_id, goal)

    def _flush_feedback(self) -> None:
        self._feedback.flush()

    def _has_feedback(self) -> bool:
        return bool(self._node.count_publishers(self._feedback_topic) > 0)

    def _destroy_parts(self) -> None:
        self._undo.close()
