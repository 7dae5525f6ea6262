# SPDX-License-Identifier: Apache-2.0
"""Publishing by clients: their advertisements, and their messages into ROS."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import partial
from typing import Final

from gateway.codec.error_text import CodecError
from gateway.codec.types import MessageType
from gateway.core.advertisement_ids import AdvertisementIds
from gateway.core.commands.interface import CommandTopics
from gateway.core.errors import NothingThereError, ProtocolError, over_limit, unknown_topic
from gateway.core.names import TopicName, resolve_topic
from gateway.core.raw_values import RawValues
from gateway.core.requests import Advertise, Publish, Unadvertise
from gateway.core.session import Session
from gateway.core.tasks import FAILURES, refuse
from gateway.core.topic_counts import CountsByTopic, TopicCounts
from gateway.core.topic_events import TopicEvents, warning
from gateway.core.topic_types import TopicTypes
from gateway.core.topics.published_pictures import PublishedPictures
from gateway.core.topics.requested_qos import offered
from gateway.metrics.state import ClientPublication
from gateway.sources.source import Publisher, Ros, RosError, TopicEvent

LARGE_CDR_BYTES: Final = 1024**2  # encoding and handing over take a turn each


@dataclass(slots=True)
class Advertised:
    """One client's advertisements of one topic. They share a ROS publisher."""

    request: Advertise  # the first one
    message_type: MessageType
    publisher: Publisher
    keeps_newest: bool  # its depth is 1: the newest message is all that counts
    has_pictures: bool  # compressed, which ROS gets as pixels
    counts: TopicCounts
    messages: int = 0  # that were published
    size: int = 0  # of them, in bytes
    ids: AdvertisementIds = field(default_factory=AdvertisementIds)

    def send(self, cdr: bytes) -> None:
        """Publish a message into ROS."""
        self.publisher.publish(cdr)
        self.messages += 1
        self.size += len(cdr)


class Publications:
    """Opens and closes ROS publishers as clients come and go, and publishes through them.

    `CommandTopics` carries out the operations on command topics.
    """

    def __init__(
        self,
        ros: Ros,
        types: TopicTypes,
        commands: CommandTopics,
        counts: CountsByTopic,
        events: TopicEvents,
        pictures: PublishedPictures,
    ) -> None:
        self._ros = ros
        self._pictures = pictures
        self._events = events
        self._counts = counts
        self._types = types
        self._commands = commands
        self._advertised: dict[Session, dict[TopicName, Advertised]] = {}

    @property
    def publishers(self) -> int:
        """The number of open ROS publishers."""
        return sum(map(len, self._advertised.values()))

    def count(self, session: Session) -> int:
        """Count the publishers of a client."""
        return len(self._advertised.get(session, ()))

    def client_publications(self) -> Iterator[ClientPublication]:
        """Yield what each client has published on each topic, command topics aside."""
        for session, own in self._advertised.items():
            for topic, known in own.items():
                yield ClientPublication(session.client, topic, known.messages, known.size)

    def advertise(self, session: Session, request: Advertise) -> None:
        """Open a publisher, or add an id to the one that the client has.

        Raises:
            ProtocolError: it is refused, and nothing has changed.
            RosError: ROS refuses it, and nothing has changed.
        """
        topic = resolve_topic(request.topic, session.limits.max_name_characters)
        if topic in self._commands:
            if request.has_pictures:
                self._pictures.check(self._types.named(request.type))
            self._commands.advertise(session, topic, request)
            return
        known = self._advertised.get(session, {}).get(topic)
        if known is None:
            known = self._open(session, topic, request)
            text = f"advertised {topic} ({known.message_type.name})"
            session.inform(text, request)
        else:
            self._check_type(topic, known, request.type)
            if request.has_pictures != known.has_pictures:
                form = "images" if known.has_pictures else "plain messages"
                raise ProtocolError("type_conflict", f"topic {topic} is advertised for {form}")
        known.ids.add(request.id)

    def unadvertise(self, session: Session, request: Unadvertise) -> None:
        """Withdraw one advertisement, or without an id all of the client's on the topic.

        Raises:
            ProtocolError: the client has not advertised it.
        """
        topic = resolve_topic(request.topic, session.limits.max_name_characters)
        if topic in self._commands:
            self._commands.unadvertise(session, topic, request)
            return
        own = self._advertised.get(session, {})
        known = own.get(topic)
        if known is None or (request.id is not None and request.id not in known.ids):
            with_id = "" if request.id is None else f" with id {request.id!r}"
            raise NothingThereError(f"not advertised: {topic}{with_id}")
        known.ids.discard(request.id)
        if request.id is None or not known.ids:
            self._pictures.forget(session, topic)
            self._close(topic, known)
            del own[topic]
            if not own:
                del self._advertised[session]

    def publish(self, session: Session, request: Publish) -> None:
        """Publish one message. Advertise the topic first if the client has not.

        Raises:
            ProtocolError: the topic, its type or the message is wrong.
            RosError: ROS refuses to create the publisher.
        """
        topic = resolve_topic(request.topic, session.limits.max_name_characters)
        if topic in self._commands:
            self._commands.publish(session, topic, request)
            return
        known = self._advertised.get(session, {}).get(topic)
        if known is None:
            known = self._open(session, topic, request)
            known.ids.add(request.id)
        elif request.type is not None:
            self._check_type(topic, known, request.type)
        if known.keeps_newest and session.turns.is_behind:
            # the next operation may withdraw the topic
            send = partial(self._send, session, topic, known, request, is_in_turn=True)
            session.defer(topic, request, send)
        else:
            self._send(session, topic, known, request)

    def refresh(self) -> None:
        """Publish with the definitions that types have by now."""
        for session, own in self._advertised.items():
            for topic, known in own.items():
                message_type = self._types.get(known.message_type.name)
                if message_type is known.message_type:
                    continue
                try:
                    opened = self._open_publisher(session, topic, known.request, message_type)
                except RosError as error:
                    problem = ProtocolError(error.code, f"topic {topic}: {error}")
                    session.warn(problem, known.request)
                    continue
                known.publisher.close()
                known.publisher, known.message_type = opened, message_type

    def leave(self, session: Session) -> None:
        """Close all advertisements of a client."""
        self._pictures.leave(session)
        for topic, known in self._advertised.pop(session, {}).items():
            self._close(topic, known)

    def _open(self, session: Session, topic: TopicName, request: Advertise | Publish) -> Advertised:
        limit = session.limits.max_advertisements
        own = self._advertised.get(session, {})
        if len(own) >= limit:
            raise over_limit(limit, "advertisements per client", "max_advertisements")
        session.check_share()
        message_type = self._types.on_topic(topic, request.type)
        if message_type is None:
            raise ProtocolError("not_found", unknown_topic(topic))
        if isinstance(request, Publish):
            request = Advertise(
                id=request.id,
                topic=request.topic,
                type=message_type.name,
                latch=request.latch,
                queue_size=request.queue_size,
                qos=request.qos,
            )
        if request.has_pictures:
            self._pictures.check(message_type)
        qos = offered(request, message_type)
        publisher = self._open_publisher(session, topic, request, message_type)
        keeps_newest = qos.depth == 1 and qos.history != "keep_all"
        counts = self._counts.open(topic)
        known = Advertised(
            request, message_type, publisher, keeps_newest, request.has_pictures, counts
        )
        self._advertised.setdefault(session, {})[topic] = known
        return known

    def _open_publisher(
        self, session: Session, topic: TopicName, request: Advertise, message_type: MessageType
    ) -> Publisher:
        on_event = partial(self._on_event, topic, session, request)
        qos = offered(request, message_type)
        return self._ros.publishing.advertise(topic, message_type.name, qos, on_event)

    def _on_event(
        self, topic: TopicName, session: Session, request: Advertise, event: TopicEvent
    ) -> None:
        """Warn a client of what keeps its messages from others."""
        self._events.report(topic, event)
        session.warn(warning(event, session), request)

    def _send(
        self,
        session: Session,
        topic: TopicName,
        known: Advertised,
        request: Publish,
        *,
        is_in_turn: bool = False,
    ) -> None:
        if known.has_pictures:
            send = partial(self._send_later, session, topic, known)
            self._pictures.publish(session, topic, known.message_type, request, send)
            return
        cdr = self._encoded(known.message_type, request.msg)
        if len(cdr) > LARGE_CDR_BYTES and not is_in_turn:
            session.turns.next_turn(partial(self._send_large, session, topic, known, cdr, request))
        else:
            known.send(cdr)

    def _encoded(self, message_type: MessageType, message: object) -> bytes:
        if isinstance(message, RawValues):
            return message.cdr
        try:
            return message_type.encode(message, self._ros.now_ns)
        except CodecError as error:
            raise ProtocolError("invalid_value", str(error)) from error

    def _send_large(
        self,
        session: Session,
        topic: TopicName,
        known: Advertised,
        cdr: bytes,
        request: Publish,
    ) -> None:
        try:
            self._send_later(session, topic, known, cdr)
        except FAILURES as error:
            refuse(session, request, error)

    def _send_later(
        self, session: Session, topic: TopicName, known: Advertised, cdr: bytes
    ) -> None:
        """Send a message that has taken some time, unless the advertisement has ended."""
        if self._advertised.get(session, {}).get(topic) is known:
            known.send(cdr)

    def _close(self, topic: TopicName, known: Advertised) -> None:
        known.publisher.close()
        known.counts.publish(known.messages, known.size)
        self._counts.close(topic)

    def _check_type(self, topic: TopicName, known: Advertised, requested: str | int) -> None:
        named = self._types.named(requested)
        if named.name != known.message_type.name:
            raise ProtocolError(
                "type_conflict",
                f"topic {topic} is advertised as {known.message_type.name}, not {named.name}",
            )
