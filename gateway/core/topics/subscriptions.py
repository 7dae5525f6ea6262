# SPDX-License-Identifier: Apache-2.0
"""The subscriptions of all clients, and the topics that feed them."""

from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Executor
from functools import partial

from gateway.codec.picture import COMPRESSED_IMAGE, IMAGE
from gateway.core.errors import NothingThereError, ProtocolError, over_limit
from gateway.core.names import TopicName, resolve_topic
from gateway.core.requests import Subscribe, Unsubscribe
from gateway.core.session import Session
from gateway.core.topic_counts import CountsByTopic
from gateway.core.topic_events import TopicEvents
from gateway.core.topic_types import TopicTypes, TypeAskedError
from gateway.core.topics.large_samples import EncodingResources
from gateway.core.topics.picture_adaptation import STEPS, Step
from gateway.core.topics.requested_clouds import requested_cloud
from gateway.core.topics.requested_pictures import fits_link, requested_picture
from gateway.core.topics.requested_qos import subscribed
from gateway.core.topics.silence_watch import SilenceWatch
from gateway.core.topics.subscribe_requests import (
    check_content,
    check_fields,
    report,
    topic_meant,
    with_bounded_queue,
)
from gateway.core.topics.subscription import EncodingKey, Feed, Subscription, TopicKey
from gateway.core.topics.subscription_options import SubscriptionOptions
from gateway.core.topics.topic import Topic
from gateway.metrics.state import ClientTopic, Delivery
from gateway.sources.source import Qos, Ros, RosError


class Subscriptions:
    """Opens and closes topics as clients subscribe and unsubscribe.

    *workers* encode pictures.
    """

    def __init__(
        self,
        ros: Ros,
        types: TopicTypes,
        workers: Executor,
        counts: CountsByTopic,
        events: TopicEvents,
    ) -> None:
        self._ros = ros
        self._types = types
        self._resources = EncodingResources(workers)
        self._counts = counts
        self._events = events
        self._topics: dict[TopicKey, Topic] = {}
        self._subscriptions: dict[Session, dict[str, Subscription]] = {}  # by requested name
        self._silence_watch = SilenceWatch(self._heard_ns)

    @property
    def topics(self) -> int:
        """The number of ROS subscriptions that are open."""
        return len(self._topics)

    def count(self, session: Session) -> int:
        """Count the topics that a client subscribes to, also those that are not known yet."""
        return len(self._subscriptions.get(session, ()))

    def client_topics(self) -> Iterator[ClientTopic]:
        """Yield what has become of the samples of each topic for each client."""
        for session, own in self._subscriptions.items():
            deliveries: dict[str, Delivery] = {}
            for subscription in own.values():  # of one topic there may be several, by name
                known = deliveries.get(subscription.topic_name)
                delivery = subscription.delivery
                deliveries[subscription.topic_name] = delivery.plus(known) if known else delivery
            client = session.client
            for name, delivery in deliveries.items():
                yield ClientTopic(client, name, delivery)

    def offers(self, key: TopicKey) -> Sequence[Qos]:
        """Return what the publishers of an open topic offer."""
        return self._topics[key].offers

    def rates_hz(self, now_ns: int) -> dict[str, float]:
        """Return how often samples arrive on the topics that are being received."""
        rates_hz: dict[str, float] = {}
        for topic in self._topics.values():  # of one name there may be several, by QoS and type
            name = topic.key.name
            rates_hz[name] = max(rates_hz.get(name, 0.0), topic.rate_hz(now_ns))
        return rates_hz

    def subscribe(self, session: Session, request: Subscribe) -> None:
        """Add a request to a subscription, or replace the one with the same id.

        Raises:
            ProtocolError: it is refused, and nothing has changed.
            RosError: ROS refuses it, and nothing has changed.
        """
        name = resolve_topic(request.topic, session.limits.max_name_characters)
        check_content(request)
        subscription = self._subscriptions.get(session, {}).get(request.topic)
        request = with_bounded_queue(request, session)
        requests = dict(subscription.requests) if subscription else {}
        if request.id not in requests:
            self._check_room(session)
        if subscription is None:
            session.check_share()
        requests.pop(request.id, None)  # so that what replaces it counts as the newest
        requests[request.id] = request
        options = SubscriptionOptions.merge(requests.values())
        source, asked = None, None
        try:
            step = STEPS[0] if subscription is None else subscription.adaptation.step
            source = self._find_source(session, name, request.topic, options, step)
        except TypeAskedError as error:
            asked = error
        if source is not None:
            # its own as well: merged with a request for everything it has none
            message_type = self._types.get(source.topic.type_name)
            check_fields(message_type, request.fields)
            self._open(source.topic)
        if subscription is None:
            counts = self._counts.open(name)
            subscription = Subscription(
                session, request.topic, name, requests, options, counts, self._on_step
            )
            self._subscriptions.setdefault(session, {})[request.topic] = subscription
        former = subscription.source
        self._apply(subscription, requests, options, source)
        if source is not None and former is not None and source.topic == former.topic:
            self._topics[source.topic].catch_up_again(subscription)
        report(subscription, request, source, asked, self._ros)

    def view(self, session: Session, request: Subscribe) -> None:
        """Subscribe to a topic of pictures that is there.

        Raises:
            ProtocolError: it is refused, and nothing has changed.
            RosError: ROS refuses it, and nothing has changed.
        """
        name = resolve_topic(request.topic, session.limits.max_name_characters)
        message_type = self._types.on_topic(name, None) if session.sees(name) else None
        if message_type is None:
            hint = topic_meant(name, self._ros.graph(), session)
            raise ProtocolError("not_found", f"topic {name} is not known{hint}")
        if message_type.name not in {IMAGE, COMPRESSED_IMAGE}:
            text = f"topic {name} is {message_type.name}, but images are {IMAGE} or CompressedImage"
            raise ProtocolError("bad_type", text)
        self.subscribe(session, request)

    def unsubscribe(self, session: Session, request: Unsubscribe) -> None:
        """End one request, or all of the client's for the topic.

        Raises:
            ProtocolError: the client has no such request.
        """
        name = resolve_topic(request.topic, session.limits.max_name_characters)
        found = False
        for subscription in list(self._subscriptions.get(session, {}).values()):
            requests = dict(subscription.requests)
            if subscription.topic_name != name or (
                request.id is not None and request.id not in requests
            ):
                continue
            found = True
            if request.id is None:
                requests.clear()
            else:
                del requests[request.id]
            if requests:
                self._reapply(subscription, requests)
            else:
                self._close(subscription)
        if not found:
            with_id = "" if request.id is None else f" with id {request.id!r}"
            raise NothingThereError(f"not subscribed to {name}{with_id}")

    def leave(self, session: Session) -> None:
        """End everything that a client subscribed to."""
        for subscription in list(self._subscriptions.get(session, {}).values()):
            self._close(subscription)
        for key in list(self._topics):  # also one that a fault of ours left without subscriptions
            self._close_if_idle(key)

    def refresh(self) -> None:
        """Follow the graph: topics that appeared, topics that came back with another type."""
        waiting = []
        for subscription in self._all():
            # a client that names the type itself hears of a mismatch from ROS instead
            if subscription.source is not None and subscription.options.type is None:
                types = self._ros.topic_types(subscription.topic_name)
                if types and subscription.source.topic.type_name not in types:
                    self._move(subscription, None)
            if subscription.source is not None and self._is_outdated(subscription.source.topic):
                self._move(subscription, None)
            if subscription.source is None:
                waiting.append(subscription)
        # One participant cannot have a topic with two types: only now is the old one closed.
        for subscription in waiting:
            self._reapply(subscription, subscription.requests)

    def _is_outdated(self, key: TopicKey) -> bool:
        """Return whether the definition of a topic's type is another one by now."""
        return self._topics[key].message_type is not self._types.get(key.type_name)

    def _heard_ns(self, subscription: Subscription) -> int:
        source = subscription.source
        return 0 if source is None else self._topics[source.topic].heard_ns

    def _all(self) -> Iterator[Subscription]:
        for own in self._subscriptions.values():
            yield from own.values()

    def _check_room(self, session: Session) -> None:
        limit = session.limits.max_subscriptions
        own = self._subscriptions.get(session, {}).values()
        if sum(len(subscription.requests) for subscription in own) >= limit:
            raise over_limit(limit, "subscriptions per client", "max_subscriptions")

    def _find_source(
        self,
        session: Session,
        name: TopicName,
        requested_name: str,
        options: SubscriptionOptions,
        step: Step,
    ) -> Feed | None:
        """Return what feeds a subscription with these options. ``None``: the type is not known.

        *step* says how much smaller than asked for pictures that fit the link are.
        """
        message_type = self._types.on_topic(name, options.type)
        if message_type is None:
            return None
        check_fields(message_type, options.fields)
        image = requested_picture(message_type, options, session.image_format, step)
        cloud = requested_cloud(message_type, options)
        is_json = options.framing.content == "json" and image is None and cloud is None
        nonfinite = options.framing.nonfinite if is_json else None
        return Feed(
            TopicKey(name, message_type.name, subscribed(options, message_type)),
            EncodingKey(
                options.framing,
                requested_name,
                options.fields,
                image,
                nonfinite or "null",
                cloud,
            ),
        )

    def _reapply(
        self, subscription: Subscription, requests: Mapping[str | int | None, Subscribe]
    ) -> None:
        """Feed a subscription as these requests ask now.

        If that is refused, it is fed as before, and its client is warned, once.
        """
        options = SubscriptionOptions.merge(requests.values())
        try:
            source = self._find_source(
                subscription.session,
                subscription.topic_name,
                subscription.requested_name,
                options,
                subscription.adaptation.step,
            )
            if source is not None:
                self._open(source.topic)
            self._apply(subscription, requests, options, source)
        except TypeAskedError:
            subscription.wait(requests)
        except (ProtocolError, RosError) as error:
            subscription.wait(requests, error)

    def _apply(
        self,
        subscription: Subscription,
        requests: Mapping[str | int | None, Subscribe],
        options: SubscriptionOptions,
        source: Feed | None,
    ) -> None:
        subscription.change(requests, options)
        self._move(subscription, source)
        image = None if source is None else source.encoding.image
        adapts = image is not None and fits_link(options, image)
        subscription.follow_link(adapts=adapts)
        self._silence_watch.follow(subscription)
        subscription.session.wake()

    def _move(self, subscription: Subscription, source: Feed | None) -> None:
        """Feed a subscription from another source, whose topic is open, or from none."""
        former = subscription.source
        if source == former:
            return
        is_same_topic = source is not None and former is not None and source.topic == former.topic
        if not is_same_topic:
            subscription.clear()
        if source is None:
            subscription.feed(None)
        else:
            self._topics[source.topic].add(subscription, source.encoding)
            subscription.feed(source, self._topics[source.topic].is_latched)
        if source is not None and not is_same_topic:
            self._topics[source.topic].catch_up(subscription, source.encoding)
        if former is not None:
            self._topics[former.topic].remove(subscription, former.encoding)
            self._close_if_idle(former.topic)

    def _on_step(self, subscription: Subscription) -> None:
        """Feed a subscription with pictures of another size, if it is still there."""
        own = self._subscriptions.get(subscription.session, {})
        if own.get(subscription.requested_name) is subscription:
            self._reapply(subscription, subscription.requests)

    def _open(self, key: TopicKey) -> None:
        """Open a topic unless it is open. It is closed with its last subscription."""
        if key not in self._topics:
            message_type = self._types.get(key.type_name)
            counts = self._counts.open(key.name)
            try:
                report = partial(self._events.report, key.name)
                self._topics[key] = Topic(
                    key, message_type, self._ros, self._resources, counts, report
                )
            except RosError:
                self._counts.close(key.name)
                raise

    def _close_if_idle(self, key: TopicKey) -> None:
        if self._topics[key].is_idle:
            self._topics.pop(key).close()
            self._counts.close(key.name)

    def _close(self, subscription: Subscription) -> None:
        own = self._subscriptions[subscription.session]
        del own[subscription.requested_name]
        if not own:
            del self._subscriptions[subscription.session]
        self._silence_watch.forget(subscription)
        self._move(subscription, None)
        name = subscription.topic_name
        subscription.close(next((each for each in own.values() if each.topic_name == name), None))
        self._counts.close(subscription.topic_name)
