# SPDX-License-Identifier: Apache-2.0
"""tf2_web_republisher as a ROS 2 action: the transforms are the feedback of a goal."""

from collections.abc import Callable
from functools import partial
from typing import Final, NamedTuple

import orjson

from gateway.codec.error_text import truncate
from gateway.core import requests
from gateway.core.errors import ProtocolError
from gateway.core.session import Session
from gateway.core.transforms.republications import Republication, Republications
from gateway.fronts.rosbridge import messages
from gateway.fronts.rosbridge.operations import ClientOperation
from gateway.fronts.rosbridge.operations.actions import CancelActionGoal, SendActionGoal
from gateway.fronts.rosbridge.session import RosbridgeSession
from gateway.fronts.rosbridge.tf2_web_republisher.requests import RepublishRequest, array_key, parse
from gateway.sources.actions import SUCCEEDED
from gateway.sources.source import Ros

ACTION: Final = "/tf2_web_republisher"
NAMES: Final = (ACTION, ACTION[1:])
# The package is tf2_web_republisher, tf2_web_republisher_msgs or tf2_web_republisher_interfaces.
_TYPE: Final = "TFSubscription"


class _Goal(NamedTuple):
    """A goal under way. Its request, which may be large, is not kept."""

    action: str  # as requested
    fragment_size: int | None
    republication: Republication


class RepublisherAction:
    """Carries out goals of clients, unless a node provides the action."""

    def __init__(self, ros: Ros, republications: Republications) -> None:
        self._ros = ros
        self._republications = republications
        self._goals: dict[Session, dict[str | int | None, _Goal]] = {}

    def work(
        self, session: RosbridgeSession, operation: ClientOperation
    ) -> Callable[[], None] | None:
        """Return what carries out an operation, if it is for this action."""
        match operation:
            case SendActionGoal(action=name) if name in NAMES:
                if not self._ros.action_types(ACTION):
                    return partial(self._send, session, operation)
            case CancelActionGoal(action=name) if name in NAMES:
                if operation.id in self._goals.get(session, {}):
                    return partial(self._cancel, session, operation)
        return None

    def leave(self, session: Session) -> None:
        """Forget the goals of a client."""
        self._goals.pop(session, None)

    def _send(self, session: RosbridgeSession, request: SendActionGoal) -> None:
        asked = request.action_type
        if asked is not None and asked.split("/")[-1] != _TYPE:
            text = f"action {ACTION} has type tf2_web_republisher_msgs/action/{_TYPE}"
            raise ProtocolError("type_conflict", f"{text}, not {truncate(asked)}")
        if not request.feedback:
            text = "feedback: expected true, because the transforms come as feedback"
            raise ProtocolError("bad_request", text)
        own = self._goals.get(session, {})
        if request.id in own:
            raise ProtocolError(
                "bad_request", f"id: {request.id!r} is already in use by an unfinished goal"
            )
        goal = parse(RepublishRequest, request.args, "args")
        wrap = partial(_feedback, session, request.action, request.id, request.fragment_size)
        about = requests.SendActionGoal(id=request.id, action=request.action)
        added = self._republications.add(session, array_key(goal), about, wrap)
        kept = _Goal(request.action, request.fragment_size, added)
        self._goals.setdefault(session, own)[request.id] = kept
        self._republications.begin(added)

    def _cancel(self, session: RosbridgeSession, request: CancelActionGoal) -> None:
        own = self._goals[session]
        goal = own.pop(request.id)
        if not own:
            del self._goals[session]
        self._republications.end(goal.republication)
        # As the node of ROS 2 does: roslib cancels a goal whenever it follows one frame more, and
        # writes an error to the console about a goal that ends otherwise.
        frame = messages.action_result(goal.action, request.id, {}, status=SUCCEEDED, result=True)
        session.send(frame, goal.fragment_size)


def _feedback(
    session: RosbridgeSession,
    action: str,
    request_id: str | int | None,
    fragment_size: int | None,
    transforms: bytes,
) -> bytes:
    """Return an array of transforms as `messages.action_feedback` would."""
    identity = b"" if request_id is None else b',"id":' + orjson.dumps(request_id)
    payload = b'{"op":"action_feedback","action":%b,"values":{"transforms":%b}%b}'
    frame = payload % (orjson.dumps(action), transforms, identity)
    return session.framed(frame, fragment_size)
