# SPDX-License-Identifier: Apache-2.0
"""Raw subscriptions that follow what their publishers offer."""

import asyncio
from collections.abc import Callable, Sequence
from functools import partial
from typing import Final

from rclpy.node import Node

from gateway.sources.name_checks import check_topic
from gateway.sources.qos import (
    Endpoint,
    adopt,
    gone,
    is_same_request,
    offered,
    retains,
    unmatched_publishers,
)
from gateway.sources.rclpy.errors import creation, remapped
from gateway.sources.rclpy.graph import read_offers, read_repairing
from gateway.sources.rclpy.heard_samples import HeardSamples
from gateway.sources.rclpy.message_classes import MessageClasses
from gateway.sources.rclpy.profile import to_profile
from gateway.sources.rclpy.qos_events import QosEvents, QosWatch
from gateway.sources.rclpy.samples import OnLost, Reader, Samples, unheard
from gateway.sources.rclpy.versions import other_versions
from gateway.sources.source import (
    BRIEF_LIFESPAN_NS,
    MAX_TAKES_PER_TURN,
    Qos,
    RosError,
    Sample,
    TopicEvent,
)

# Publishers have discovered a new reader by then: Fast DDS repairs what is lost within 3 s.
RETIREMENT_S: Final = BRIEF_LIFESPAN_NS / 1e9


class RawSubscriptions:
    """The subscriptions of one node."""

    def __init__(
        self,
        node: Node,
        samples: Samples,
        events: QosEvents,
        loop: asyncio.AbstractEventLoop,
        on_change: Callable[[], None],
        classes: MessageClasses,
    ) -> None:
        self._node = node
        self.events = events
        self.classes = classes
        self._on_change = on_change
        self._samples = samples
        self._loop = loop
        self._open: set[RawSubscription] = set()

    def __len__(self) -> int:
        """Count the open subscriptions."""
        return len(self._open)

    def after(self, seconds: float, callback: Callable[[], None]) -> asyncio.TimerHandle:
        """Call back on the loop."""
        return self._loop.call_later(seconds, callback)

    def subscribe(
        self,
        topic: str,
        type_name: str,
        qos: Qos,
        on_samples: Callable[[Sequence[Sample]], None],
        on_event: Callable[[TopicEvent], None],
    ) -> "RawSubscription":
        """Open a subscription. See `gateway.sources.source.Source.subscribe`."""
        check_topic(topic)
        subscription = RawSubscription(
            self, topic, type_name, qos, on_samples, on_event, self.offers(topic)
        )
        self._open.add(subscription)
        self._on_change()
        # Not from within this call: the caller does not hold the subscription yet.
        self._loop.call_soon(subscription.report)
        return subscription

    def type_of(self, topic: str) -> str | None:
        """Return the type of an open subscription to a topic, if there is one."""
        return next((s.type_name for s in self._open if s.topic == topic), None)

    def follow_publishers(self) -> None:
        """Let every subscription follow what its publishers offer now."""
        for subscription in list(self._open):
            subscription.follow(self.offers(subscription.topic))

    def offers(self, topic: str) -> list[Endpoint]:
        """Return what the publishers of a topic offer now."""
        return read_offers(self._node, topic)

    def repairing(self, topic: str, qos: Qos) -> frozenset[bytes]:
        """Return the ids of the publishers that send such a reader again what it has lost."""
        return read_repairing(self._node, topic, qos)

    def read(
        self,
        topic: str,
        found: type,
        qos: Qos,
        on_samples: Callable[[Sequence[Sample]], None],
        on_lost: OnLost = unheard,
    ) -> Reader:
        """Create rclpy's subscription.

        Raises:
            RosError: ROS refuses it, or gives it another name.
        """
        with creation(f"topic {topic}"):
            reader = self._samples.read(found, topic, to_profile(qos), on_samples, on_lost)
        given = reader.topic_name
        if given != topic:
            reader.close()
            raise remapped(f"topic {topic}", given)
        return reader

    def forget(self, subscription: "RawSubscription") -> None:
        """Remove a closed subscription."""
        self._open.discard(subscription)
        self._on_change()

    def close(self) -> None:
        """Close every subscription that is still open."""
        for subscription in list(self._open):
            subscription.close()


class RawSubscription:
    """One handle. rclpy's subscription behind it is replaced when the offers require another.

    The retired one stays until publishers have discovered its successor, so nothing is lost.
    Samples that come to both are delivered once, and so are those that transient-local publishers
    repeat.
    """

    def __init__(
        self,
        subscriptions: RawSubscriptions,
        topic: str,
        type_name: str,
        asked: Qos,
        on_samples: Callable[[Sequence[Sample]], None],
        on_event: Callable[[TopicEvent], None],
        offers: Sequence[Endpoint],
    ) -> None:
        self.topic = topic
        self.type_name = type_name
        self._subscriptions = subscriptions
        self._message_class = subscriptions.classes.get(type_name)
        self._type_hash = subscriptions.classes.hash_of(type_name)
        self._asked = asked
        self._on_samples = on_samples
        self._on_event = on_event
        self._offers = offers
        # why the profile that the offers require is not in force
        self._refusals: list[TopicEvent] = []
        self._reported: list[TopicEvent] = []
        self.lost = 0
        self.qos = adopt(asked, self._matching(offers))  # complete
        self._reader: Reader | None = self._read(self.qos)
        self._watch: QosWatch | None = self._watched(self._reader)
        self._retired: Reader | None = None  # the one before, for a while
        self._timer: asyncio.TimerHandle | None = None  # while samples may come to two readers
        self._heard = HeardSamples()
        self._choose_delivery()

    @property
    def publishers(self) -> int:
        """The number of publishers that it is matched with."""
        return 0 if self._reader is None else self._reader.publishers

    @property
    def offers(self) -> list[Qos]:
        """The offers of the publishers of its type now."""
        return offered(self._matching(self._subscriptions.offers(self.topic)))

    def join_late(self, on_samples: Callable[[Sequence[Sample]], None]) -> Reader:
        """Open a second reader. See `gateway.sources.source.RosSubscription.join_late`."""
        reader = self._subscriptions.read(self.topic, self._message_class, self.qos, on_samples)
        reader.deliver_to(on_samples, with_publishers=True)
        return reader

    @property
    def incompatible(self) -> tuple[TopicEvent, ...]:
        """The mismatches that were reported and still hold."""
        return tuple(self._reported)

    def close(self) -> None:
        """Destroy it. No callback comes after. Closing twice is harmless."""
        self._subscriptions.forget(self)
        self._unwatch()
        self._stop_timer()
        readers = (self._retired, self._reader)
        self._retired = self._reader = None
        for reader in readers:
            if reader is not None:
                reader.close()

    def follow(self, offers: Sequence[Endpoint]) -> None:
        """Adopt what the publishers offer now, and report those that cannot be matched."""
        if self._reader is None:
            return
        if offers == self._offers and not self._refusals:  # most are, of a change elsewhere
            return
        before, self._offers = self._matching(self._offers), offers
        qos = adopt(self._asked, self._matching(offers), self.qos)
        self._refusals.clear()
        if not is_same_request(qos, self.qos):
            self._replace(self._reader, qos)
        self._choose_delivery()
        for event in gone(self.topic, before, self._matching(offers)):
            if self._reader is not None:  # a callback may close this
                self._on_event(event)
        self.report()

    def report(self) -> None:
        """Report each publisher that cannot be matched, once for as long as that lasts."""
        known = self._reported
        topic, type_name, offers = self.topic, self.type_name, self._offers
        unmatched = unmatched_publishers(topic, type_name, self.qos, offers)
        others = other_versions(topic, type_name, self._type_hash, offers)
        self._reported = [*self._refusals, *unmatched, *others]
        for reason in self._reported:
            if reason not in known and self._reader is not None:  # a callback may close this
                self._on_event(reason)

    def _replace(self, retired: Reader, qos: Qos) -> None:
        self._end_retirement()  # of one before
        if self._reader is None:  # a callback has closed this
            return
        repaired = self._subscriptions.repairing(self.topic, self.qos)
        try:
            reader = self._read(qos)
        except RosError as error:
            kept = f"keeping reliability {self.qos.reliability}"
            self._refusals.append(TopicEvent("qos_incompatible", str(error), kept))
            return
        self._unwatch()
        self.qos = qos
        self._retired, self._reader = retired, reader
        self._watch = self._watched(reader)
        self._heard.begin(is_latched=self._is_latched(), repaired=repaired)
        retired.deliver_to(partial(self._compare, retired), with_publishers=True)
        self._stop_timer()
        self._timer = self._subscriptions.after(RETIREMENT_S, self._end_retirement)

    def _end_retirement(self) -> None:
        retired, self._retired = self._retired, None
        if retired is None:
            return
        # its last samples may be on their way to its successor
        self._stop_timer()
        self._timer = self._subscriptions.after(RETIREMENT_S, self._end_comparison)
        try:
            retired.flush()
            self._deliver(self._heard.end())
        finally:
            retired.close()

    def _end_comparison(self) -> None:
        self._timer = None
        self._choose_delivery()

    def _stop_timer(self) -> None:
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _choose_delivery(self) -> None:
        """Compare samples only while one may come twice: others are to be fast."""
        reader = self._reader
        if reader is None:
            return
        if self._timer is not None or self._may_repeat():
            reader.deliver_to(partial(self._compare, reader), with_publishers=True)
        else:
            self._heard.forget()
            reader.deliver_to(self._on_samples, with_publishers=False)

    def _may_repeat(self) -> bool:
        """Return whether a later reader may get again what this one gets."""
        if self._asked.durability == "volatile":
            return False
        offers = self._matching(self._offers)
        return not offers or self._is_latched() or any(map(retains, offers))

    def _is_latched(self) -> bool:
        return self.qos.durability == "transient_local"

    def _compare(self, reader: Reader, samples: Sequence[Sample]) -> None:
        """Deliver what a reader has taken, unless it was delivered before."""
        if reader is self._reader and not self._matching(self._offers):
            # before the first sample: its publisher may retain earlier ones, which go before it
            self.follow(self._subscriptions.offers(self.topic))
        if reader is self._reader and self._retired is not None:
            self._retired.flush()  # it has what was published before the other one was discovered
        heard = self._heard
        self._deliver(heard.new(samples) if reader is self._reader else heard.retired(samples))

    def _deliver(self, samples: Sequence[Sample]) -> None:
        for first in range(0, len(samples), MAX_TAKES_PER_TURN):
            if self._reader is not None:  # a callback may close this
                self._on_samples(samples[first : first + MAX_TAKES_PER_TURN])

    def _watched(self, reader: Reader) -> QosWatch:
        events = self._subscriptions.events
        return events.of_subscription(reader, self.topic, self.qos, self._on_event)

    def _unwatch(self) -> None:
        watch, self._watch = self._watch, None
        if watch is not None:
            watch.close()

    def _read(self, qos: Qos) -> Reader:
        return self._subscriptions.read(
            self.topic, self._message_class, qos, self._on_samples, self._on_lost
        )

    def _on_lost(self, number: int) -> None:
        self.lost += number

    def _matching(self, offers: Sequence[Endpoint]) -> list[Endpoint]:
        return [offer for offer in offers if offer.type_name == self.type_name]
