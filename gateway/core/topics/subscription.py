# SPDX-License-Identifier: Apache-2.0
"""One client's subscription to one topic: its options, its pace and its queue."""

import asyncio
import time
from collections.abc import Callable, Mapping
from typing import NamedTuple

from gateway.codec.cloud import CloudOptions
from gateway.codec.image import ImageOptions
from gateway.codec.nonfinite import NonFinite
from gateway.core.entries import Entry
from gateway.core.errors import ProtocolError
from gateway.core.frames import Framing
from gateway.core.names import TopicName
from gateway.core.requests import Subscribe
from gateway.core.session import Session
from gateway.core.topic_counts import NOTHING_DELIVERED, TopicCounts
from gateway.core.topics.picture_adaptation import PictureAdaptation
from gateway.core.topics.subscription_options import SubscriptionOptions
from gateway.core.topics.throttle import Throttle
from gateway.metrics.state import Delivery
from gateway.sources.source import Qos, RosError


class TopicKey(NamedTuple):
    """Subscriptions with equal keys share one ROS subscription."""

    name: TopicName
    type_name: str
    qos: Qos


class EncodingKey(NamedTuple):
    """Subscriptions to one topic with equal keys share the bytes of each sample."""

    framing: Framing
    requested_name: str  # of the topic: clients match frames by that text
    fields: tuple[str, ...] | None
    image: ImageOptions | None  # None: a plain message
    nonfinite: NonFinite = "null"  # of CBOR, and of pictures, always
    cloud: CloudOptions | None = None  # None: a plain message


class Feed(NamedTuple):
    """The topic and the encoding of it that feed a subscription."""

    topic: TopicKey
    encoding: EncodingKey


class Subscription:
    """All of one client's `subscribe` requests for one topic, under one requested name.

    Runs on the event loop's thread. The topic that feeds it offers it every sample. `source` says
    which that is, ``None`` while the type of the topic is not known.
    """

    __slots__ = (
        "_adapts",
        "_counts",
        "_is_late",
        "_last_refusal",
        "_on_step",
        "_throttle",
        "_timer",
        "adaptation",
        "inherited",
        "is_direct",
        "is_latched",
        "lost_before",
        "offered",
        "options",
        "queue",
        "requested_name",
        "requests",
        "session",
        "shares_frames",
        "source",
        "topic_name",
    )

    def __init__(
        self,
        session: Session,
        requested_name: str,
        topic_name: TopicName,
        requests: Mapping[str | int | None, Subscribe],
        options: SubscriptionOptions,
        counts: TopicCounts,
        on_step: Callable[["Subscription"], None],
    ) -> None:
        """Open its queue. *requests* stand by their ids, oldest first, and amount to *options*.

        *on_step* is called when its pictures are to have another size.
        """
        self.session = session
        self._is_late = False
        self.requested_name = requested_name
        self.topic_name = topic_name
        self.requests = requests
        self.options = options
        self.source: Feed | None = None
        self.is_latched: Callable[[], bool] = _is_never  # as its topic has found out
        self._last_refusal = ""  # of another source, as the client was warned
        self.offered = 0
        self.lost_before = 0  # samples that never came to be offered
        self.queue = session.outbox.open_queue(*options.queue_bounds, self)
        self._counts = counts
        self.inherited = NOTHING_DELIVERED  # of others of this client and topic, which have ended
        self.adaptation = PictureAdaptation()
        self._adapts = False  # its pictures are to fit the link
        self._on_step = on_step
        self._throttle = _throttle(options)
        self._timer: asyncio.TimerHandle | None = None  # while the throttle holds an entry
        self._note_frames()

    @property
    def newest_request(self) -> Subscribe:
        """The request that warnings are about."""
        return list(self.requests.values())[-1]

    @property
    def delivery(self) -> Delivery:
        """The samples that were offered, and what has become of them, with what it inherited."""
        queue, throttle = self.queue, self._throttle
        own = Delivery(
            offered=self.offered,
            sent=queue.sent,
            sent_bytes=queue.sent_bytes,
            coalesced=queue.coalesced,
            dropped=queue.dropped + queue.discarded,
            pending=queue.pending + (0 if throttle is None else len(throttle)),
        )
        return own.plus(self.inherited)

    @property
    def lost(self) -> int:
        """The samples that the client will never get, as it, its throttle or DDS was too slow."""
        return self.lost_before + self.queue.dropped + self.queue.coalesced

    def offer(
        self, entry: Entry, now_ns: int, *, more: bool, publisher: bytes | None = None
    ) -> bool:
        """Take an entry, now or at the end of the throttle's interval. *more* follow at once.

        On a latched topic it stands for no entry of another *publisher*.

        Return whether the client has to be woken, as `Queue.put` does.
        """
        self.offered += 1
        throttle = self._throttle
        if throttle is None or throttle.passes(now_ns):
            return self.queue.put(entry, more=more)
        whose = publisher if self.is_latched() else None
        self.queue.coalesce(throttle.hold(entry, whose))
        if self._timer is None:
            self._wait_for(throttle, now_ns)
        return False

    def change(
        self, requests: Mapping[str | int | None, Subscribe], options: SubscriptionOptions
    ) -> None:
        """Go on with other requests. Entries that wait are still delivered.

        Another throttle begins at once: what the former one holds passes.
        """
        if options.pace != self.options.pace:
            self._release_all()
            self._throttle = _throttle(options)
        self.requests = requests
        self.options = options
        self._last_refusal = ""
        self._note_frames()
        self.queue.bound(*options.queue_bounds)

    def wait(
        self,
        requests: Mapping[str | int | None, Subscribe],
        refusal: ProtocolError | RosError | None = None,
    ) -> None:
        """Go on as before, because other requests cannot be met yet. Warn once of a *refusal*."""
        self.requests = requests
        if refusal is not None and str(refusal) != self._last_refusal:
            self._last_refusal = str(refusal)
            text = f"{refusal}, waiting for {self.topic_name} to change"
            self.warn(ProtocolError(refusal.code, text))

    def feed(self, source: Feed | None, is_latched: Callable[[], bool] | None = None) -> None:
        """Note what feeds it from now on, and whether that is a latched topic."""
        self.source = source
        self.is_latched = is_latched or _is_never

    def lose(self, count: int) -> None:
        """Count samples that never came to be offered."""
        self.lost_before += count

    def follow_link(self, *, adapts: bool) -> None:
        """Note whether the frames that are sent from now on are pictures that fit the link."""
        throttled = 0 if self._throttle is None else len(self._throttle)
        self.adaptation.stepped(self.queue.pending + throttled)
        self._adapts = adapts

    @property
    def follows_link(self) -> bool:
        """True while its pictures are to fit the link."""
        return self._adapts

    def set_late(self, *, is_late: bool) -> None:
        """Note whether it gets retained samples, of which others have got frames long ago."""
        self._is_late = is_late
        self._note_frames()

    def clear(self) -> None:
        """Deliver nothing of what has come so far."""
        self._stop_timer()
        if self._throttle is None:
            self.queue.clear()
            return
        self.queue.clear(others=len(self._throttle))
        self._throttle.clear()

    def close(self, successor: "Subscription | None" = None) -> None:
        """Deliver nothing any more.

        *successor* is another one of the client to the topic: the counts of both must not fall.
        """
        self.clear()
        self.session.outbox.close_queue(self.queue)
        if successor is None:
            self._counts.deliver(self.delivery)
        else:
            successor.inherited = successor.inherited.plus(self.delivery)

    def warn(self, error: ProtocolError) -> None:
        """Warn the client of something that its subscription suffers from."""
        request = self.newest_request
        self.session.warn(error, request)

    def sent_at_once(self, arrived_ns: int) -> None:
        """Note how long a sample took from DDS to the socket, unless it waits."""
        throttle = self._throttle
        if not self.queue.pending and not throttle:
            self.has_timed(arrived_ns)

    def _note_frames(self) -> None:
        self.shares_frames = not (self._is_late or self.options.needs_own_frames)
        # each shared frame goes out as it comes, but to ROS#, which says later what it is
        self.is_direct = self.shares_frames and self._throttle is None

    def has_sent(self, size: int) -> None:
        """Judge by a picture that is sent whether the next ones need another size."""
        if not self._adapts:
            return
        bytes_per_s = self.session.outbox.bytes_per_s
        if self.adaptation.sent(size, bytes_per_s, time.monotonic_ns()):
            # now, queues and encodings are being gone through
            asyncio.get_running_loop().call_soon(self._on_step, self)

    def has_timed(self, arrived_ns: int) -> None:
        """Note how long an entry took that is handed to the socket now."""
        if arrived_ns:
            time_s = (time.time_ns() - arrived_ns) / 1e9
            self._counts.latency.observe(time_s)
            self.session.latency.observe(time_s)

    def _wait_for(self, throttle: Throttle, now_ns: int) -> None:
        delay_s = (throttle.due_ns - now_ns) / 1e9
        self._timer = asyncio.get_running_loop().call_later(delay_s, self._on_interval)

    def _on_interval(self) -> None:
        self._stop_timer()
        throttle = self._throttle
        if throttle is None:
            return
        now_ns = time.monotonic_ns()
        held = throttle.release(now_ns)
        if held is not None:
            self.queue.put(held)
        if throttle:
            self._wait_for(throttle, now_ns)
        self.session.wake()

    def _release_all(self) -> None:
        self._stop_timer()
        while self._throttle and (held := self._throttle.release(0)) is not None:
            self.queue.put(held)

    def _stop_timer(self) -> None:
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None


def _is_never() -> bool:
    return False


def _throttle(options: SubscriptionOptions) -> Throttle | None:
    return Throttle(options.pace) if options.pace.interval_ns else None
