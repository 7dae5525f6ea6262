# SPDX-License-Identifier: Apache-2.0
"""Subscriptions through Zenoh. Samples stay CDR.

QoS keeps no endpoints apart here, so one reader serves for all publishers. It asks their caches for
what they keep, unless a client wants nothing that was published before.
"""

import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any, Final

import zenoh
from zenoh import ext

from gateway.sources.qos import Endpoint, adopt, gone, offered, unmatched_publishers
from gateway.sources.source import Qos, Sample, TopicEvent
from gateway.sources.zenoh.attachment import read_attachment
from gateway.sources.zenoh.events import other_versions
from gateway.sources.zenoh.heard_publishers import SampleNumbers, UnlistedPublishers
from gateway.sources.zenoh.inbox import Arrival, Arrivals, Inbox
from gateway.sources.zenoh.keys import NO_TYPE_HASH, WireError
from gateway.sources.zenoh.session import ZenohSession
from gateway.sources.zenoh.token_graph import TokenGraph
from gateway.sources.zenoh.tokens import CPU

BUFFERS: Final = "/_buf_cpu"  # behind the key of a topic, since Lyrical

OnSamples = Callable[[Sequence[Sample]], None]


class ZenohReader:
    """One subscriber of Zenoh. It delivers the samples that have one of the accepted hashes."""

    def __init__(
        self, place: "ZenohSubscription", on_samples: OnSamples, *, retained: bool, depth: int
    ) -> None:
        self._place = place
        self._on_samples = on_samples
        self.numbers = SampleNumbers()
        session, inbox = place.all_of_them.session, place.all_of_them.inbox
        self._arrivals = Arrivals(depth, self._deliver)
        self._suffixes = tuple(f"/{each}" for each in place.accepted_hashes)
        key = session.data_key(place.topic, place.type_name, "*").text
        history = None
        if retained:
            history = ext.HistoryConfig(detect_late_publishers=True, max_samples=depth)
        put, arrivals = inbox.put, self._arrivals

        def arrive(sample: Any) -> None:  # on a thread of Zenoh
            attachment = sample.attachment
            of_publisher = b"" if attachment is None else attachment.to_bytes()
            cdr, now_ns = sample.payload.to_bytes(), time.time_ns()
            put(arrivals, Arrival(cdr, of_publisher, now_ns, str(sample.key_expr)))

        # By default, each callback has its own thread, and the order among them is lost.
        in_order = place.all_of_them.in_order
        self._arrive = zenoh.handlers.Callback(arrive, indirect=not in_order)
        self._key = key
        self._of_buffers: Any = None
        self._subscriber: Any = ext.declare_advanced_subscriber(
            session.zenoh, key, self._arrive, history=history, subscriber_detection=retained
        )

    @property
    def publishers(self) -> int:
        """The number of publishers that it is matched with."""
        return 0 if self._subscriber is None else len(self._place.matching())

    def hear_buffers(self, *, wanted: bool) -> None:
        """Hear what publishers of Lyrical put for those that need no accelerator, or no longer."""
        before, self._of_buffers = self._of_buffers, None
        if wanted and self._subscriber is not None:
            session = self._place.all_of_them.session.zenoh
            self._of_buffers = session.declare_subscriber(self._key + BUFFERS, self._arrive)
        if before is not None:
            before.undeclare()

    def flush(self) -> None:
        """Deliver all that has arrived."""
        self._place.all_of_them.inbox.flush(self._arrivals)

    def close(self) -> None:
        """End it. No callback follows. Closing twice is harmless."""
        subscriber, self._subscriber = self._subscriber, None
        self._arrivals.close()
        self.hear_buffers(wanted=False)
        if subscriber is not None:
            subscriber.undeclare()

    def _deliver(self, arrivals: Sequence[Arrival]) -> None:
        samples = list(self._read(arrivals))
        if samples:
            self._place.has_heard = True
            self._on_samples(samples)

    def _read(self, arrivals: Sequence[Arrival]) -> Iterator[Sample]:
        unlisted = self._place.all_of_them.unlisted
        for cdr, attachment, received_ns, key in arrivals:
            if self._suffixes and not key.removesuffix(BUFFERS).endswith(self._suffixes):
                continue
            try:
                number, source_ns, gid = read_attachment(attachment)
            except WireError as error:
                self._place.all_of_them.foreign.note(str(error))
                continue
            self.numbers.note(gid, number)
            unlisted.hear(gid)
            # recordings cannot hold a time before 1970
            yield Sample(cdr, received_ns, max(source_ns, 0), number, gid)


class ForeignSamples:
    """Counts samples that no node of ROS has published."""

    def __init__(self, on_first: Callable[[str], None]) -> None:
        self.count = 0
        self._on_first = on_first

    def note(self, why: str) -> None:
        """Note one. The first is reported."""
        self.count += 1
        if self.count == 1:
            self._on_first(why)


class ZenohSubscriptions:
    """All subscriptions of a session. Those *in_order* also keep their order among the answers."""

    def __init__(
        self,
        session: ZenohSession,
        node: str,
        graph: TokenGraph,
        inbox: Inbox,
        foreign: ForeignSamples,
        *,
        in_order: bool = False,
    ) -> None:
        self.in_order = in_order
        self.session, self.node, self.graph, self.inbox = session, node, graph, inbox
        self.unlisted = UnlistedPublishers(graph.has_publisher)
        self.foreign = foreign
        self.open: dict[ZenohSubscription, None] = {}

    def type_of(self, topic: str) -> str | None:
        """Return the type of an open subscription to a topic, if there is one."""
        return next((each.type_name for each in self.open if each.topic == topic), None)

    def follow_publishers(self) -> None:
        """Let every subscription follow what its publishers offer now."""
        for each in list(self.open):
            each.follow()

    def close(self) -> None:
        """Close every subscription that is still open."""
        for each in list(self.open):
            each.close()


class ZenohSubscription:
    """Implements `gateway.sources.source.RosSubscription`."""

    def __init__(
        self,
        all_of_them: ZenohSubscriptions,
        stream: tuple[str, str],
        own_hash: str | None,
        asked: Qos,
        on_samples: OnSamples,
        on_event: Callable[[TopicEvent], None],
    ) -> None:
        self.all_of_them = all_of_them
        self.topic, self.type_name = stream
        self._own_hash = own_hash
        # Without a definition any would do. Humble's nodes show no hash.
        self.accepted_hashes = () if own_hash is None else (own_hash, NO_TYPE_HASH)
        self._asked = asked
        self._on_event = on_event
        self.has_heard, self.since_s = False, time.monotonic()
        self._offers = self._all_offers()
        self._reported: list[TopicEvent] = []
        self.qos = adopt(asked, self._matching(self._offers))
        self._reader: ZenohReader | None = ZenohReader(
            self, on_samples, retained=asked.durability != "volatile", depth=self.qos.depth or 1
        )
        self._hears_buffers = all_of_them.graph.has_buffers(self.topic, self.type_name)
        self._reader.hear_buffers(wanted=self._hears_buffers)
        self._token = self._declare()
        all_of_them.open[self] = None

    @property
    def publishers(self) -> int:
        """The number of publishers that it is matched with."""
        return 0 if self._reader is None else self._reader.publishers

    @property
    def probe_key(self) -> str:
        """A key that only readers of any hash hear. See `gateway.sources.zenoh.refusals`."""
        return self.all_of_them.session.data_key(self.topic, self.type_name, "probe").text

    @property
    def offers(self) -> Sequence[Qos]:
        """The offers of the publishers of its type now."""
        return offered(self._matching(self._all_offers()))

    @property
    def lost(self) -> int:
        """The number of samples that were published and never came."""
        return 0 if self._reader is None else self._reader.numbers.lost

    @property
    def incompatible(self) -> tuple[TopicEvent, ...]:
        """The mismatches that were reported and still hold."""
        return tuple(self._reported)

    def join_late(self, on_samples: OnSamples) -> ZenohReader:
        """Open a second reader, which gets what the publishers keep."""
        return ZenohReader(self, on_samples, retained=True, depth=self.qos.depth or 1)

    def flush(self) -> None:
        """Deliver all that has arrived."""
        if self._reader is not None:
            self._reader.flush()

    def matching(self) -> list[Endpoint]:
        """Return the offers whose samples can be read here."""
        return self._matching(self._offers)

    def follow(self) -> None:
        """Adopt what the publishers offer now, and report those whose samples do not come."""
        offers = self._all_offers()
        self._follow_buffers()
        if self._reader is None or offers == self._offers:
            return
        before, self._offers = self._matching(self._offers), offers
        self.qos = adopt(self._asked, self._matching(offers), self.qos)
        for event in gone(self.topic, before, self._matching(offers)):
            self._on_event(event)
        self.report()

    def report(self) -> None:
        """Report each publisher that cannot be matched, once for as long as that lasts."""
        known = self._reported
        offers = self._offers
        # an open profile: here, no offer is refused for its QoS
        unmatched = unmatched_publishers(self.topic, self.type_name, Qos(), offers)
        self._reported = [*unmatched, *self._other_versions()]
        for reason in self._reported:
            if reason not in known and self._reader is not None:  # a callback may close this
                self._on_event(reason)

    def close(self) -> None:
        """End it. No callback follows. Closing twice is harmless."""
        reader, self._reader = self._reader, None
        if reader is None:
            return
        reader.close()
        self.all_of_them.open.pop(self, None)
        self.all_of_them.graph.remove(self._token)
        self.all_of_them.session.remove(self._token)

    def _follow_buffers(self) -> None:
        """Leave their buffers to publishers of Lyrical.

        For a subscription whose token names no backend, they publish to all in the plain way.
        """
        wanted = self.all_of_them.graph.has_buffers(self.topic, self.type_name)
        if wanted == self._hears_buffers or self._reader is None:
            return
        self._hears_buffers = wanted
        self._reader.hear_buffers(wanted=wanted)
        before, self._token = self._token, self._declare()
        self.all_of_them.graph.remove(before)
        self.all_of_them.session.remove(before)

    def _declare(self) -> str:
        backends = CPU if self._hears_buffers else None
        session = self.all_of_them.session
        key = session.data_key(self.topic, self.type_name, self._own_hash or NO_TYPE_HASH)
        token = session.add_endpoint(self.all_of_them.node, "MS", key, self.qos, backends)
        self.all_of_them.graph.add(token)
        return token

    def _all_offers(self) -> list[Endpoint]:
        return self.all_of_them.graph.offers(self.topic)

    def _matching(self, offers: Sequence[Endpoint]) -> list[Endpoint]:
        return [
            each
            for each in offers
            if each.type_name == self.type_name and not self._is_other_version(each)
        ]

    def _is_other_version(self, offer: Endpoint) -> bool:
        return self._own_hash is not None and offer.type_hash not in {None, self._own_hash}

    def _other_versions(self) -> list[TopicEvent]:
        of_type = (each for each in self._offers if each.type_name == self.type_name)
        others = filter(self._is_other_version, of_type)
        return other_versions(self.topic, self.type_name, others, "its messages do not arrive")
