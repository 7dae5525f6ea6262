# SPDX-License-Identifier: Apache-2.0
"""Which client gets which topic: streams on one side, feeds from ROS on the other."""

import difflib
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from gateway.codec.error_text import truncate
from gateway.codec.errors import FieldError
from gateway.codec.image import ImageOptions
from gateway.codec.types import MessageType
from gateway.ports import Graph, Ros, RosError
from gateway.protocol.errors import ProtocolError
from gateway.protocol.names import TopicName, resolve_topic
from gateway.protocol.operations import Subscribe, Unsubscribe
from gateway.protocol.publish_frames import Compression
from gateway.protocol.session import Session
from gateway.protocol.subscription_options import Stream, Wish, compression
from gateway.router.topic_types import TopicTypes
from gateway.router.topics.encoding import Rendition, RenditionKey
from gateway.router.topics.encodings import Renditions
from gateway.router.topics.latch import make_latch
from gateway.router.topics.requested_qos import requested
from gateway.router.topics.topic import Feed, FeedKey, Member

_NO_COMPRESSION = frozenset({None, "", "none"})


@dataclass(slots=True)
class Subscribed:
    """All of one client's subscriptions to one topic, spelt one way."""

    session: Session
    spelling: str
    topic: TopicName
    requests: dict[str | int | None, Subscribe] = field(default_factory=dict)  # oldest first
    member: Member | None = None
    feed: Feed | None = None  # None: the type is not known yet
    complaint: str = ""  # why it cannot be fed, as far as the client knows


class Source(NamedTuple):
    """What serves a wish: a ROS subscription, and a rendition of what it delivers."""

    feed: FeedKey
    rendition: RenditionKey


class Subscriptions:
    """Opens and closes ROS subscriptions as clients come and go."""

    def __init__(self, ros: Ros, types: TopicTypes, renditions: Renditions) -> None:
        self._ros = ros
        self._types = types
        self._renditions = renditions
        self._feeds: dict[FeedKey, Feed] = {}
        self._subscribed: dict[Session, dict[str, Subscribed]] = {}

    @property
    def feeds(self) -> int:
        """How many ROS subscriptions are open."""
        return len(self._feeds)

    def rates_hz(self, now_ns: int) -> dict[str, float]:
        """Return how often samples arrive on the topics that are being received."""
        return {feed.key.topic: feed.rate_hz(now_ns) for feed in self._feeds.values()}

    def subscribe(self, session: Session, request: Subscribe) -> None:
        """Add a subscription, or replace the one with the same id.

        Raises:
            ProtocolError: it is refused, and nothing has changed.
            RosError: ROS refuses it, and nothing has changed.
        """
        topic = resolve_topic(request.topic, session.limits.name_characters)
        own = self._subscribed.get(session, {})
        known = own.get(request.topic)
        requests = dict(known.requests) if known else {}
        requests.pop(request.id, None)  # so that what replaces it counts as the newest
        requests[request.id] = request
        count = sum(len(entry.requests) for entry in own.values())
        if (known is None or request.id not in known.requests) and (
            count >= session.limits.subscriptions
        ):
            raise ProtocolError(
                "limit_exceeded", f"at most {session.limits.subscriptions} subscriptions per client"
            )
        wish = Wish.merge(requests.values())
        if wish.queue_length is not None and wish.queue_length > session.limits.queue_length:
            raise ProtocolError(
                "limit_exceeded",
                f"queue_length: {wish.queue_length}, at most {session.limits.queue_length} allowed",
            )
        entry = known or Subscribed(session, request.topic, topic)
        source = self._source(entry, wish)
        if source is not None:
            # its own as well: merged with a subscription to everything it has none
            _check_fields(
                self._types.get(source.feed.type_name), request.fields, compression(request)
            )
        self._attach(entry, requests, wish, source)
        self._subscribed.setdefault(session, {})[request.topic] = entry
        if compression(request) == "none" and request.compression not in _NO_COMPRESSION:
            asked = truncate(request.compression or "")
            text = f"compression: {asked!r} is not available; sending plain JSON"
            session.warn(ProtocolError("bad_request", text), request.op, request.id)
        if source is None:
            hint = _did_you_mean(topic, self._ros.graph())
            session.warn(
                ProtocolError("not_found", f"topic {topic} is not known yet{hint}; waiting for it"),
                request.op,
                request.id,
            )
        else:
            session.inform(
                f"subscribed to {topic} ({source.feed.type_name})", request.op, request.id
            )

    def unsubscribe(self, session: Session, request: Unsubscribe) -> None:
        """End one subscription, or all of the client's on the topic.

        Raises:
            ProtocolError: there is none.
        """
        topic = resolve_topic(request.topic, session.limits.name_characters)
        found = False
        for entry in list(self._subscribed.get(session, {}).values()):
            if entry.topic != topic or (
                request.id is not None and request.id not in entry.requests
            ):
                continue
            found = True
            if request.id is None:
                entry.requests.clear()
            else:
                del entry.requests[request.id]
            if entry.requests:
                self._try_again(entry)
            else:
                self._forget(entry)
        if not found:
            with_id = "" if request.id is None else f" with id {request.id!r}"
            raise ProtocolError("not_found", f"not subscribed to {topic}{with_id}")

    def leave(self, session: Session) -> None:
        """End everything that a client subscribed to."""
        for entry in list(self._subscribed.get(session, {}).values()):
            self._forget(entry)

    def refresh(self) -> None:
        """Follow the graph: topics that appeared, topics that came back with another type."""
        waiting = []
        for entry in self._entries():
            member = entry.member
            # a client that named the type itself hears of a mismatch from ROS instead
            if entry.feed is not None and member is not None and member.stream.wish.type is None:
                types = self._ros.topic_types(entry.topic)
                if types and entry.feed.key.type_name not in types:
                    self._detach(entry)
            if entry.feed is None:
                waiting.append(entry)
        # One participant cannot have a topic with two types: only now is the old one closed.
        for entry in waiting:
            self._try_again(entry)

    def _try_again(self, entry: Subscribed) -> None:
        """Attach as wished now; where that fails, the client is told, once, and all stays."""
        wish = Wish.merge(entry.requests.values())
        try:
            self._attach(entry, entry.requests, wish, self._source(entry, wish))
            entry.complaint = ""
        except (ProtocolError, RosError) as error:
            if str(error) == entry.complaint:
                return
            entry.complaint = str(error)
            request = next(reversed(entry.requests.values()))
            refusal = ProtocolError(error.code, f"{error}; waiting for {entry.topic} to change")
            entry.session.warn(refusal, request.op, request.id)

    def _entries(self) -> Iterator[Subscribed]:
        for own in self._subscribed.values():
            yield from own.values()

    def _source(self, entry: Subscribed, wish: Wish) -> Source | None:
        """Return what serves a wish; ``None`` while nobody knows the topic's type."""
        message_type = self._types.on_topic(entry.topic, wish.type)
        if message_type is None:
            return None
        _check_fields(message_type, wish.fields, wish.compression)
        image = _pictures(message_type, wish)
        return Source(
            FeedKey(entry.topic, message_type.name, requested(wish.qos)),
            RenditionKey(entry.spelling, wish.fields, image, wish.compression),
        )

    def _attach(
        self,
        entry: Subscribed,
        requests: dict[str | int | None, Subscribe],
        wish: Wish,
        source: Source | None,
    ) -> None:
        """Have a stream fed as requests amount to; raises before anything has changed."""
        feed = None if source is None else self._feeds.get(source.feed) or self._open(source.feed)
        entry.requests = requests
        if entry.member is None:
            stream = Stream(entry.spelling, wish, entry.session.outbox)
            entry.member = Member(entry.session, stream, self._ros.now_ns)
        member = entry.member
        member.change(wish)
        member.request_id = next(reversed(requests))
        former, former_rendition = entry.feed, member.rendition
        if feed is not former:
            # A frame in the works would be announced to the former feed's members only; and what
            # is kept for late streams comes anew.
            member.cancel()
        entry.feed, member.rendition = feed, None
        if feed is not None and source is not None:
            feed.join(member, source.rendition, replay=feed is not former)
        # only now, so that a feed that goes on is not closed and opened again
        self._leave(former, member, former_rendition)
        member.session.wake()

    def _detach(self, entry: Subscribed) -> None:
        if entry.member is not None:
            former, former_rendition = entry.feed, entry.member.rendition
            entry.feed = entry.member.rendition = None
            entry.member.cancel()
            self._leave(former, entry.member, former_rendition)

    def _leave(self, feed: Feed | None, member: Member, rendition: Rendition | None) -> None:
        if feed is None or rendition is None:
            return
        feed.leave(member, rendition)
        if feed.is_idle:
            feed.close()
            del self._feeds[feed.key]

    def _open(self, key: FeedKey) -> Feed:
        latch = make_latch(key.topic, self._types.get(key.type_name))
        feed = Feed(key, self._renditions.make, latch)
        feed.subscription = self._ros.subscribe(
            key.topic,
            key.type_name,
            key.qos,
            feed.on_samples,
            feed.on_incompatible,
        )
        self._feeds[key] = feed
        return feed

    def _forget(self, entry: Subscribed) -> None:
        own = self._subscribed[entry.session]
        del own[entry.spelling]
        if not own:
            del self._subscribed[entry.session]
        self._detach(entry)
        if entry.member is not None:
            entry.session.outbox.close_queue(entry.member.stream.queue)


def _check_fields(
    message_type: MessageType, fields: tuple[str, ...] | None, asked: Compression
) -> None:
    """Refuse fields that a message has not, or that cannot be told apart as it travels."""
    try:
        message_type.check_fields(fields)
    except FieldError as error:
        raise ProtocolError("bad_request", f"fields: {truncate(str(error))}") from error
    if fields is not None and asked == "cbor-raw":
        text = "fields: cbor-raw is CDR untouched; choose cbor for some fields of it"
        raise ProtocolError("bad_request", text)


def _pictures(message_type: MessageType, wish: Wish) -> ImageOptions | None:
    """Return the picture options where a stream gets pictures instead of plain messages."""
    image = wish.image
    if message_type.name != "sensor_msgs/msg/Image" or wish.fields or image.format == "raw":
        return None
    if wish.compression == "cbor-raw":
        return None
    options = ImageOptions(image.format, image.quality, image.max_width, image.max_height)
    if image.depth_range_m is None:
        return options
    try:
        return replace(options, depth_range_m=image.depth_range_m)
    except ValueError as error:
        raise ProtocolError("bad_request", f"image: {error}") from error


def _did_you_mean(topic: str, graph: Graph) -> str:
    near = difflib.get_close_matches(topic, [known.name for known in graph.topics], n=1)
    return f"; did you mean {near[0]}?" if near else ""
