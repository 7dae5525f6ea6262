# SPDX-License-Identifier: Apache-2.0
"""tf2_web_republisher as an action of ROS 1: topics for goals, for cancelling and for feedback.

They are those of actionlib. That of its results and its status nobody needs: a goal only ends when
its client says so.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Final

import orjson

from gateway.codec.json import dumps
from gateway.core import requests
from gateway.core.errors import NothingThereError, ProtocolError
from gateway.core.ros_time import stamp
from gateway.core.session import Session
from gateway.core.transforms.republications import Republication, Republications
from gateway.fronts.rosbridge.operations import ClientOperation
from gateway.fronts.rosbridge.operations.topics import (
    Advertise,
    Publish,
    Subscribe,
    Unadvertise,
    Unsubscribe,
)
from gateway.fronts.rosbridge.session import RosbridgeSession
from gateway.fronts.rosbridge.tf2_web_republisher.requests import (
    ActionGoal,
    GoalId,
    RepublishRequest,
    array_key,
    parse,
)
from gateway.fronts.rosbridge.tf2_web_republisher.virtual_topic import VirtualTopic
from gateway.sources.source import Ros

_GOAL: Final = "/tf2_web_republisher/goal"
_CANCEL: Final = "/tf2_web_republisher/cancel"
_FEEDBACK: Final = "/tf2_web_republisher/feedback"
_FEEDBACK_TYPE: Final = "tf2_web_republisher_msgs/msg/TFSubscriptionActionFeedback"
_GOALS: Final = (_GOAL, _GOAL[1:])
_CANCELS: Final = (_CANCEL, _CANCEL[1:])
_FEEDBACKS: Final = (_FEEDBACK, _FEEDBACK[1:])
_ACTIVE: Final = 1  # actionlib_msgs/GoalStatus


@dataclass(slots=True, eq=False)
class _Own:
    """The goals of one client, and its subscriptions to their feedback."""

    feedback: VirtualTopic
    goals: dict[str, Republication] = field(default_factory=dict)  # by the ids in their messages


class RepublisherActionlib:
    """Carries out what clients publish and subscribe to, unless ROS has a topic for goals."""

    def __init__(self, ros: Ros, republications: Republications) -> None:
        self._ros = ros
        self._republications = republications
        self._own: dict[Session, _Own] = {}

    def work(
        self, session: RosbridgeSession, operation: ClientOperation
    ) -> Callable[[], None] | None:
        """Return what carries out an operation, if it is for one of these topics."""
        work: Callable[[], None] | None = None
        match operation:
            case Advertise(topic=name) if name in _GOALS or name in _CANCELS:
                work = partial(_advertise, session, operation)
            case Unadvertise(topic=name) if name in _GOALS or name in _CANCELS:
                work = _unadvertise
            case Publish(topic=name) if name in _GOALS:
                work = partial(self._send, session, operation)
            case Publish(topic=name) if name in _CANCELS:
                work = partial(self._cancel, session, operation)
            case Subscribe(topic=name) if name in _FEEDBACKS:
                work = partial(self._subscribe, session, operation)
            case Unsubscribe(topic=name) if name in _FEEDBACKS and session in self._own:
                return partial(self._unsubscribe, session, operation)
        # a goal that began here goes on here
        is_ours = work is not None and (session in self._own or not self._ros.topic_types(_GOAL))
        return work if is_ours else None

    def leave(self, session: Session) -> None:
        """Forget the goals of a client."""
        self._own.pop(session, None)

    def _of(self, session: RosbridgeSession) -> _Own:
        return self._own.get(session) or _Own(VirtualTopic(session, _FEEDBACK, _FEEDBACK_TYPE))

    def _send(self, session: RosbridgeSession, request: Publish) -> None:
        message = parse(ActionGoal, request.msg, "msg")
        goal_id = parse(GoalId, message.goal_id, "msg.goal_id").id
        asked = parse(RepublishRequest, message.goal, "msg.goal")
        own = self._of(session)
        if goal_id in own.goals:
            text = f"msg.goal_id.id: {goal_id!r} is already in use by an unfinished goal"
            raise ProtocolError("bad_request", text)
        wrap = partial(self._feedback, own.feedback, goal_id)
        about = requests.Publish(id=request.id, topic=request.topic, msg=None)
        goal = own.goals[goal_id] = self._republications.add(session, array_key(asked), about, wrap)
        self._own[session] = own
        if own.feedback:
            self._republications.begin(goal)

    def _cancel(self, session: RosbridgeSession, request: Publish) -> None:
        goal_id = parse(GoalId, request.msg, "msg").id
        own = self._of(session)
        ended = [goal_id] if goal_id else list(own.goals)
        for each in ended:
            goal = own.goals.pop(each, None)
            if goal is None:
                raise NothingThereError(f"msg.id: no goal {each!r} is under way")
            self._republications.end(goal)
        self._forget_idle(session, own)

    def _subscribe(self, session: RosbridgeSession, request: Subscribe) -> None:
        own = self._of(session)
        own.feedback.subscribe(request)
        self._own[session] = own
        for goal in own.goals.values():
            self._republications.begin(goal)

    def _unsubscribe(self, session: RosbridgeSession, request: Unsubscribe) -> None:
        own = self._own[session]
        own.feedback.unsubscribe(request)
        if not own.feedback:  # roslib does not cancel the goal of a client that it disposes of
            for goal in own.goals.values():
                self._republications.end(goal)
            own.goals.clear()
        self._forget_idle(session, own)

    def _forget_idle(self, session: RosbridgeSession, own: _Own) -> None:
        if not (own.feedback or own.goals):
            self._own.pop(session, None)

    def _feedback(self, topic: VirtualTopic, goal_id: str, transforms: bytes) -> bytes:
        header = {"stamp": stamp(self._ros.now_ns()), "frame_id": ""}
        known = orjson.dumps({"stamp": stamp(0), "id": goal_id})
        message = (
            b'{"header":%b,"status":{"goal_id":%b,"status":%d,"text":""}'
            b',"feedback":{"transforms":%b}}'
        )
        return topic.frames(message % (dumps(header), known, _ACTIVE, transforms))


def _advertise(session: RosbridgeSession, request: Advertise) -> None:
    session.inform(f"advertised {request.topic} (answered by the gateway)", request.request())


def _unadvertise() -> None:
    """Do nothing: advertising has done nothing either."""
