# SPDX-License-Identifier: Apache-2.0
"""Actions: send a goal, or provide the action."""

from typing import Any

from gateway.codec.nonfinite import NonFinite
from gateway.core import requests
from gateway.fronts.rosbridge.operations.base import FragmentSize, Id, Operation


class SendActionGoal(Operation):
    """Send a goal. The answer is an `action_result` with the same id, whatever happens."""

    op = "send_action_goal"
    makes = requests.SendActionGoal
    action: str
    action_type: str | None = None
    args: Any = None  # an object, or the values of the fields in order
    feedback: bool = False
    nonfinite: NonFinite = "null"  # of feedback and result
    keep: bool = False  # do not cancel the goal when this client leaves
    fragment_size: FragmentSize = None

    def request(self) -> requests.SendActionGoal:
        """Return it for the core."""
        return requests.SendActionGoal(
            id=self.id,
            action=self.action,
            action_type=self.action_type,
            args=self.args,
            feedback=self.feedback,
            keep=self.keep,
            form=self,
        )


class CancelActionGoal(Operation):
    """Ask to cancel a goal by its id. Its result reports whether it was cancelled."""

    op = "cancel_action_goal"
    makes = requests.CancelActionGoal
    action: str
    id: Id


class AdvertiseAction(Operation):
    """Provide an action: the client gets `send_action_goal` and `cancel_action_goal`."""

    op = "advertise_action"
    makes = requests.AdvertiseAction
    action: str
    type: str


class UnadvertiseAction(Operation):
    """Stop providing an action. Its goals are aborted."""

    op = "unadvertise_action"
    makes = requests.UnadvertiseAction
    action: str


class ActionFeedback(Operation):
    """Report the progress of a goal. *id* is the goal's."""

    op = "action_feedback"
    makes = requests.ActionFeedback
    action: str
    id: Id
    values: Any = None


class ActionResult(Operation):
    """End a goal. *id* is the goal's."""

    op = "action_result"
    makes = requests.ActionResult
    action: str
    id: Id
    values: Any = None
    status: int | None = None  # of action_msgs/msg/GoalStatus, roslib 1 sends none
    result: bool = True
