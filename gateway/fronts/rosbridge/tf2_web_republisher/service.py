# SPDX-License-Identifier: Apache-2.0
"""tf2_web_republisher as a service: it answers with the name of a topic to subscribe to."""

import asyncio
import secrets
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Final

from gateway.core import requests
from gateway.core.errors import ProtocolError
from gateway.core.names import resolve_topic
from gateway.core.session import Session
from gateway.core.transforms.republications import Republication, Republications
from gateway.fronts.rosbridge import messages
from gateway.fronts.rosbridge.operations import ClientOperation
from gateway.fronts.rosbridge.operations.services import CallService
from gateway.fronts.rosbridge.operations.topics import Subscribe, Unsubscribe
from gateway.fronts.rosbridge.session import RosbridgeSession
from gateway.fronts.rosbridge.tf2_web_republisher.requests import RepublishRequest, array_key, parse
from gateway.fronts.rosbridge.tf2_web_republisher.virtual_topic import VirtualTopic
from gateway.sources.source import Ros

SERVICE: Final = "/republish_tfs"
_NAMES: Final = (SERVICE, SERVICE[1:])
_TYPE: Final = "tf2_web_republisher_msgs/msg/TFArray"
# And a token that no other topic has ever had. After a lost connection, roslib subscribes again to
# its topics, and must not get the array of another client.
_TOPIC: Final = "/tf2_web_republisher/tf_repub_"
_TOKEN_BYTES: Final = 8


@dataclass(slots=True, eq=False)
class _Array:
    """An array, and the topic that it is sent on."""

    topic: VirtualTopic
    republication: Republication
    expiry: asyncio.TimerHandle  # until the client subscribes


class RepublisherService:
    """Carries out calls and subscriptions of clients, unless a node provides the service."""

    def __init__(self, ros: Ros, republications: Republications) -> None:
        self._ros = ros
        self._republications = republications
        # by their topics, to which nobody else can subscribe
        self._own: dict[Session, dict[str, _Array]] = {}

    def work(
        self, session: RosbridgeSession, operation: ClientOperation
    ) -> Callable[[], None] | None:
        """Return what carries out an operation, if it is for this service or one of its topics.

        Raises:
            ProtocolError: the name of the topic is invalid.
        """
        match operation:
            case CallService(service=name) if name in _NAMES:
                if not self._ros.service_types(SERVICE):
                    return partial(self._call, session, operation)
            case Subscribe(topic=name) if _resolved(name).startswith(_TOPIC):
                topic = resolve_topic(name, session.limits.max_name_characters)
                if topic in self._own.get(session, {}) or not self._ros.topic_types(topic):
                    return partial(self._subscribe, session, operation)
            case Unsubscribe(topic=name) if _resolved(name) in self._own.get(session, {}):
                return partial(self._unsubscribe, session, operation)
        return None

    def leave(self, session: Session) -> None:
        """Forget the topics of a client."""
        for array in self._own.pop(session, {}).values():
            array.expiry.cancel()

    def _call(self, session: RosbridgeSession, request: CallService) -> None:
        asked = parse(RepublishRequest, request.args, "args")
        name = f"{_TOPIC}{secrets.token_hex(_TOKEN_BYTES)}"
        topic = VirtualTopic(session, name, _TYPE)
        about = requests.CallService(id=request.id, service=request.service)
        wrap = partial(_frames, topic)
        added = self._republications.add(session, array_key(asked), about, wrap)
        loop = asyncio.get_running_loop()
        expiry = loop.call_later(asked.timeout_s, self._end, session, name)
        self._own.setdefault(session, {})[name] = _Array(topic, added, expiry)
        values = {"topic_name": name}
        frame = messages.service_response(request.service, request.id, values, result=True)
        session.send(frame, request.fragment_size)

    def _subscribe(self, session: RosbridgeSession, request: Subscribe) -> None:
        name = _resolved(request.topic)
        array = self._own.get(session, {}).get(name)
        if array is None:
            text = (
                f"topic {name} does not exist: call {SERVICE} for a new one, and subscribe in time"
            )
            raise ProtocolError("not_found", text)
        array.topic.subscribe(request)
        array.expiry.cancel()
        self._republications.begin(array.republication)

    def _unsubscribe(self, session: RosbridgeSession, request: Unsubscribe) -> None:
        name = _resolved(request.topic)
        topic = self._own[session][name].topic
        topic.unsubscribe(request)
        if not topic:
            self._end(session, name)

    def _end(self, session: RosbridgeSession, name: str) -> None:
        own = self._own[session]
        array = own.pop(name)
        if not own:
            del self._own[session]
        array.expiry.cancel()
        self._republications.end(array.republication)


def _resolved(name: str) -> str:
    return name if name.startswith("/") else f"/{name}"


def _frames(topic: VirtualTopic, transforms: bytes) -> bytes:
    return topic.frames(b'{"transforms":%b}' % transforms)
