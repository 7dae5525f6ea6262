# SPDX-License-Identifier: Apache-2.0
"""Actions as rclpy takes them: the classes of their parts, and the ways from CDR to their messages.

The parts that all actions share, which cancel a goal and publish its status, are not among them.
"""

from typing import Any, TypeAlias

from rclpy.serialization import deserialize_message, serialize_message

from gateway.sources.action_cdr import ActionCdr
from gateway.sources.goal_ids import with_goal_id
from gateway.sources.rclpy.interfaces import service_class
from gateway.sources.rclpy.made_types.classes import MadeAction
from gateway.sources.rclpy.made_types.raw_messages import RawMessage


def cancel_request(goal_id: bytes) -> Any:
    """Return the request that cancels a goal of any action."""
    request = service_class("action_msgs/srv/CancelGoal").Request()
    request.goal_info.goal_id.uuid = list(goal_id)
    return request


class PackageAction:
    """The form of a class that a package has.

    Goals, results and feedback are CDR, encapsulation header included. Bytes that are not CDR of
    the type raise one of `gateway.sources.rclpy.errors.REFUSALS`.
    """

    def __init__(self, type_name: str, action_class: Any) -> None:
        self.type_name = type_name
        parts = action_class.Impl
        self.send_goal = parts.SendGoalService
        self.get_result = parts.GetResultService
        self.feedback: type = parts.FeedbackMessage
        self._result = action_class.Result

    def to_goal_request(self, goal_id: bytes, goal: bytes) -> Any:
        """Return the request that sends a goal."""
        return deserialize_message(with_goal_id(goal_id, goal), self.send_goal.Request)

    def to_cancel_request(self, goal_id: bytes) -> Any:
        """Return the request that cancels a goal."""
        return cancel_request(goal_id)

    def read_goal_request(self, request: Any) -> tuple[bytes, bytes]:
        """Return the goal's id, shorter than 16 bytes if it is malformed, and the goal."""
        return bytes(request.goal_id.uuid), serialize_message(request.goal)

    def to_goal_response(self, accepted_ns: int | None) -> Any:
        """Return the response to a goal that was accepted at a time, or was rejected."""
        response = self.send_goal.Response()
        if accepted_ns is not None:
            response.accepted = True
            response.stamp.sec, response.stamp.nanosec = divmod(accepted_ns, 10**9)
        return response

    def is_accepted(self, response: Any) -> bool:
        """Return the server's answer to a goal."""
        return bool(response.accepted)

    def to_result_request(self, goal_id: bytes) -> Any:
        """Return the request for the result of a goal."""
        request = self.get_result.Request()
        request.goal_id.uuid = list(goal_id)
        return request

    def read_result_request(self, request: Any) -> bytes:
        """Return the id of the goal whose result is asked for."""
        return bytes(request.goal_id.uuid)

    def to_result_response(self, status: int, result: bytes | None = None) -> Any:
        """Return the response with a result, or with an empty one."""
        response = self.get_result.Response(status=status)
        if result is not None:
            response.result = deserialize_message(result, self._result)
        return response

    def read_result_response(self, response: Any) -> tuple[int, bytes]:
        """Return the status and the result.

        Raises:
            RosError: ``internal``: the response is not CDR of the type.
        """
        return response.status, serialize_message(response.result)


class MadeActionForm:
    """The form of the classes of `gateway.sources.rclpy.made_types`, which notice few faults."""

    def __init__(self, made: MadeAction, cdr: ActionCdr) -> None:
        self.type_name = cdr.type_name
        self.send_goal = made.send_goal
        self.get_result = made.get_result
        self.feedback = made.feedback
        self._cdr = cdr

    def to_goal_request(self, goal_id: bytes, goal: bytes) -> Any:
        """See `PackageAction`."""
        return self.send_goal.Request(self._cdr.to_goal_request(goal_id, goal))

    def to_cancel_request(self, goal_id: bytes) -> Any:
        """See `PackageAction`."""
        return cancel_request(goal_id)

    def read_goal_request(self, request: RawMessage) -> tuple[bytes, bytes]:
        """See `PackageAction`."""
        return self._cdr.read_goal_request(request.cdr)

    def to_goal_response(self, accepted_ns: int | None) -> Any:
        """See `PackageAction`."""
        return self.send_goal.Response(self._cdr.to_goal_response(accepted_ns))

    def is_accepted(self, response: RawMessage) -> bool:
        """See `PackageAction`."""
        return self._cdr.is_accepted(response.cdr)

    def to_result_request(self, goal_id: bytes) -> Any:
        """See `PackageAction`."""
        return self.get_result.Request(self._cdr.to_result_request(goal_id))

    def read_result_request(self, request: RawMessage) -> bytes:
        """See `PackageAction`."""
        return self._cdr.read_result_request(request.cdr)

    def to_result_response(self, status: int, result: bytes | None = None) -> Any:
        """See `PackageAction`."""
        return self.get_result.Response(self._cdr.to_result_response(status, result))

    def read_result_response(self, response: RawMessage) -> tuple[int, bytes]:
        """See `PackageAction`."""
        return self._cdr.read_result_response(response.cdr)


ActionForm: TypeAlias = PackageAction | MadeActionForm
