# SPDX-License-Identifier: Apache-2.0
"""tf2_web_republisher, answered by the gateway itself.

Clients of roslib and roslibpy that follow transforms ask that node for them. They do so in three
ways: by a ROS 2 action, by a service that answers with a topic, and by the topics of an action of
ROS 1. To a client it looks as if the node were there, but the ROS graph has nothing of it. If a
node provides one of them, the gateway leaves it to that node.
"""

from collections.abc import Callable, Mapping
from operator import attrgetter
from typing import Any, Final, Protocol

from gateway.core.session import Session
from gateway.core.transforms.republications import Republications
from gateway.fronts.rosbridge.operations import ClientOperation, actions, services, topics
from gateway.fronts.rosbridge.session import RosbridgeSession
from gateway.fronts.rosbridge.tf2_web_republisher.action import RepublisherAction
from gateway.fronts.rosbridge.tf2_web_republisher.actionlib import RepublisherActionlib
from gateway.fronts.rosbridge.tf2_web_republisher.service import RepublisherService
from gateway.sources.source import Ros

# How all its names begin. This is asked for every message that is published, so it comes first.
_BEGINNINGS: Final = (
    "/tf2_web_republisher",
    "tf2_web_republisher",
    "/republish_tfs",
    "republish_tfs",
)
_NAME_OF: Final[Mapping[type, Callable[[Any], str]]] = {
    topics.Publish: attrgetter("topic"),
    topics.Advertise: attrgetter("topic"),
    topics.Unadvertise: attrgetter("topic"),
    topics.Subscribe: attrgetter("topic"),
    topics.Unsubscribe: attrgetter("topic"),
    services.CallService: attrgetter("service"),
    actions.SendActionGoal: attrgetter("action"),
    actions.CancelActionGoal: attrgetter("action"),
}


class _Way(Protocol):
    """One of the ways to ask."""

    def work(
        self, session: RosbridgeSession, operation: ClientOperation
    ) -> Callable[[], None] | None:
        """Return what carries out an operation, if it is for this way."""

    def leave(self, session: Session) -> None:
        """Forget a client."""


class TfRepublisher:
    """Finds the operations that are for tf2_web_republisher, and carries them out."""

    def __init__(self, ros: Ros, republications: Republications) -> None:
        self._ways: tuple[_Way, ...] = (
            RepublisherAction(ros, republications),
            RepublisherService(ros, republications),
            RepublisherActionlib(ros, republications),
        )

    def work(
        self, session: RosbridgeSession, operation: ClientOperation
    ) -> Callable[[], None] | None:
        """Return what carries out an operation, or ``None`` if it is not for tf2_web_republisher.

        The returned function raises `ProtocolError` and `RosError` as refusals.

        Raises:
            ProtocolError: it is, and a name in it is invalid.
        """
        name_of = _NAME_OF.get(type(operation))
        if name_of is None or not name_of(operation).startswith(_BEGINNINGS):
            return None
        for way in self._ways:
            work = way.work(session, operation)
            if work is not None:
                return work
        return None

    def leave(self, session: Session) -> None:
        """Forget a client, whose arrays the core ends."""
        for way in self._ways:
            way.leave(session)
