# SPDX-License-Identifier: Apache-2.0
"""Actions in the interface of the core to a robot. See `gateway.sources.source`."""

from collections.abc import Callable
from typing import Literal, NamedTuple, Protocol

# action_msgs/msg/GoalStatus: how a goal ended
GoalOutcome = Literal[4, 5, 6]
SUCCEEDED: GoalOutcome = 4
CANCELED: GoalOutcome = 5
ABORTED: GoalOutcome = 6


class GoalResult(NamedTuple):
    """The status and the result of a goal that has ended."""

    status: GoalOutcome
    cdr: bytes  # the action's Result, with its 4-byte encapsulation header


class Goal(Protocol):
    """A goal that an action server has accepted."""

    async def result(self) -> GoalResult:
        """Wait for the end of the goal.

        Raises:
            RosError: ``not_found``: the server is gone or has forgotten the goal, or the action
                client was closed.
        """

    def cancel(self) -> None:
        """Ask the server to cancel, without waiting. `result` reports whether it did."""


class ActionClient(Protocol):
    """A client of a ROS action. Goals, feedback and results are CDR."""

    async def send_goal(self, goal: bytes, on_feedback: Callable[[bytes], None]) -> Goal | None:
        """Wait for a server and send it a goal. Return ``None`` if it rejects the goal.

        *on_feedback* gets CDR of the action's Feedback until the result arrives. Any number of
        goals may be active. The caller sets the time limit. Cancelling this gives the goal up: if
        the server still accepts it, it is cancelled.

        Raises:
            RosError: ``not_found``, as for `ServiceClient.call`.
        """

    def close(self) -> None:
        """Destroy it. Accepted goals continue. Closing twice is harmless.

        Everything that waits for it fails, and no callback follows. The client waits for a
        limited time if the server may still accept an abandoned goal, or has not answered a cancel.
        Until then it counts as open.
        """


class GoalRequest(Protocol):
    """A goal that a ROS client has sent to an action that the gateway provides.

    It counts as accepted and being executed. Its methods do nothing if the action is closed, the
    goal has finished, or its sender is gone.
    """

    @property
    def cdr(self) -> bytes:
        """The action's Goal, encapsulation header included."""

    def feedback(self, cdr: bytes) -> None:
        """Publish the action's Feedback.

        Raises:
            RosError: ``internal``: ROS cannot publish it.
        """

    def finish(self, status: GoalOutcome, result: bytes) -> None:
        """End the goal. *result* is CDR of the action's Result.

        A goal can end as canceled only while it is being canceled. Otherwise it counts as aborted.

        Raises:
            RosError: ``internal``: *result* is not CDR of the type. The goal continues.
        """


class ActionServer(Protocol):
    """A ROS action that the gateway provides."""

    def close(self) -> None:
        """Withdraw it. Unfinished goals are aborted, and no callback follows.

        Requests of callers that have not yet discovered the end are answered, goals by a
        rejection. Closing twice is harmless.
        """


class Actions(Protocol):
    """The part of a source that sends goals, and provides actions."""

    def action_client(self, action: str, type_name: str) -> ActionClient:
        """Create a client of an action by its fully resolved name.

        Raises:
            RosError: as for `subscribe`. *type_name* is ``pkg/action/Name``.
        """

    def serve_action(
        self,
        action: str,
        type_name: str,
        on_goal: Callable[[GoalRequest], None],
        on_cancel: Callable[[GoalRequest], None],
    ) -> ActionServer:
        """Provide an action by its fully resolved name.

        *on_cancel* is called once for a goal of *on_goal*'s that a client wants to cancel. The
        goal continues until it is finished.

        Raises:
            RosError: as for `action_client`. Also ``limit_exceeded`` if the gateway provides it
                already.
        """
