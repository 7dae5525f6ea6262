# SPDX-License-Identifier: Apache-2.0
"""A topic as one ROS subscription receives it, and the subscriptions that it feeds."""

import time
from collections import deque
from collections.abc import Callable, Sequence
from functools import partial
from itertools import count as numbers
from itertools import repeat
from typing import Final

from gateway.codec.error_text import CodecError
from gateway.codec.types import MessageType
from gateway.core.errors import ProtocolError
from gateway.core.topic_counts import TopicCounts
from gateway.core.topic_events import warning
from gateway.core.topics.encoders import make_encoding
from gateway.core.topics.encoding import Encoding, PerClientFrame, SharedFrame
from gateway.core.topics.fan_out import Batch, write_directly
from gateway.core.topics.large_samples import EncodedTopic, EncodingResources
from gateway.core.topics.late_join import LateJoin
from gateway.core.topics.sample_faults import SampleFaults
from gateway.core.topics.subscription import EncodingKey, Subscription, TopicKey
from gateway.sources.source import Qos, Ros, RosError, Sample, TopicEvent

# One batch in so long is timed, for so many clients in turn: a look at one costs 1 us and more.
TIMING_PERIOD_NS: Final = 100_000_000
TIMED_AT_ONCE: Final = 4
RATE_BATCHES: Final = 16  # enough to tell 30 Hz from 25, few enough to follow within a second


class Topic:
    """Offers every sample to its subscriptions: one frame per encoding, however many clients.

    Runs on the event loop's thread.
    """

    def __init__(
        self,
        key: TopicKey,
        message_type: MessageType,
        ros: Ros,
        resources: EncodingResources,
        counts: TopicCounts,
        report: Callable[[TopicEvent], None],
    ) -> None:
        """Open the ROS subscription. *report* hears of what happens on it.

        Raises:
            RosError: ROS refuses it.
        """
        self.key = key
        self.message_type = message_type
        self._ros = ros
        self._resources = resources
        self._encoded = EncodedTopic(key.name, self._wake_all, self.is_latched, ros.now_ns)
        self._counts = counts
        self._report = report
        self._encodings: dict[EncodingKey, Encoding] = {}
        self._seq = 0
        self._received: deque[tuple[int, int]] = deque(maxlen=RATE_BATCHES)  # times and numbers
        self._late_joins: dict[Subscription, LateJoin] = {}
        self._faults: dict[EncodingKey, SampleFaults] = {}  # of a picture, or of the message
        self._lost = 0  # samples, before they came here
        self._timed_ns = 0  # when the next batch is timed
        self._timed = 0  # clients
        self._ros_subscription = ros.subscribe(
            key.name, key.type_name, key.qos, self._on_samples, self._on_event
        )

    @property
    def is_idle(self) -> bool:
        """True while it has no subscriptions."""
        return not self._encodings

    @property
    def offers(self) -> Sequence[Qos]:
        """The offers of its publishers. Without any, the profile in force, which followed them."""
        return self._ros_subscription.offers or (self._ros_subscription.qos,)

    @property
    def heard_ns(self) -> int:
        """The time of the newest sample, by the monotonic clock. 0 if none has come."""
        return self._received[-1][0] if self._received else 0

    def add(self, subscription: Subscription, key: EncodingKey) -> None:
        """Feed a subscription by the encoding of this key from now on."""
        encoding = self._encodings.get(key)
        if encoding is None:
            self._faults[key] = SampleFaults(time.monotonic_ns())
            encoding = self._encodings[key] = make_encoding(
                self.message_type,
                key,
                self._encoded,
                partial(self._on_codec_error, key),
                self._resources,
            )
        encoding.subscriptions.append(subscription)

    def remove(self, subscription: Subscription, key: EncodingKey) -> None:
        """Feed a subscription no longer by the encoding of this key."""
        encoding = self._encodings[key]
        encoding.subscriptions.remove(subscription)
        if subscription in self._late_joins and not self._feeds(subscription):
            self._end_late_join(subscription)
        if not encoding.subscriptions:
            encoding.close()
            del self._encodings[key], self._faults[key]

    def catch_up(self, subscription: Subscription, key: EncodingKey) -> None:
        """Give a new subscription what has been there before: warnings, and retained samples.

        Before the first sample has come, the topic itself is a late joiner.
        """
        for mismatch in self._ros_subscription.incompatible:
            subscription.warn(warning(mismatch, subscription.session))
        self._faults[key].forget()
        if self._seq and self.is_latched():
            self._join_late(subscription)

    def catch_up_again(self, subscription: Subscription) -> None:
        """Give retained samples to a subscription again, for another request of its client.

        rosbridge does so for each `subscribe`: its libraries have a second listener of a topic send
        one, and rely on it.
        """
        if self._seq and self.is_latched():
            if subscription in self._late_joins:  # which may have delivered them already
                self._late_joins.pop(subscription).cut_short()
            self._join_late(subscription)

    def close(self) -> None:
        """End the ROS subscriptions."""
        for join in self._late_joins.values():
            join.close()
        self._ros_subscription.close()

    def rate_hz(self, now_ns: int) -> float:
        """Return how often samples arrive. 0 once they have ceased."""
        if len(self._received) < 2:  # one time has no rate
            return 0.0
        (first_ns, first), (last_ns, last) = self._received[0], self._received[-1]
        period_ns = (last_ns - first_ns) / (last - first)
        return 0.0 if now_ns - last_ns > max(3 * period_ns, 1e9) else 1e9 / max(period_ns, 1.0)

    def is_latched(self) -> bool:
        """Return whether it keeps messages for late subscribers."""
        return self._ros_subscription.qos.durability == "transient_local"

    def _on_samples(self, samples: Sequence[Sample]) -> None:
        """Offer what arrived, oldest first."""
        now_ns = time.monotonic_ns()
        count = len(samples)
        if self._ros_subscription.lost != self._lost:
            self._note_lost(self._ros_subscription.lost)
        first_seq = self._seq + 1
        self._seq += count
        self._received.append((now_ns, self._seq))
        has_waiting = False  # otherwise all have it already, and nobody is to be woken
        for encoding in self._encodings.values():
            frames = list(map(SharedFrame, repeat(encoding), samples, numbers(first_seq)))
            together = frames[0] if count == 1 else Batch(frames)
            others = write_directly(together, encoding.subscriptions, count)
            if others:
                has_waiting |= self._offer(frames, samples, others, now_ns)
        self._counts.receive(count, sum(map(len, [sample.cdr for sample in samples])))
        if now_ns >= self._timed_ns:
            self._timed_ns = now_ns + TIMING_PERIOD_NS
            self._time(samples[0].received_ns)
        if has_waiting:
            self._wake_all()

    def _offer(
        self,
        frames: Sequence[SharedFrame],
        samples: Sequence[Sample],
        subscriptions: Sequence[Subscription],
        now_ns: int,
    ) -> bool:
        """Offer one sample after the other to all. Return whether a client has to be woken."""
        more = len(frames) > 1
        has_waiting = False
        for shared, sample in zip(frames, samples, strict=True):
            for subscription in subscriptions:
                if subscription.shares_frames and not subscription.session.reads_ascii_only:
                    has_waiting |= subscription.offer(
                        shared, now_ns, more=more, publisher=sample.publisher
                    )
                elif self._passes(subscription, shared.seq, sample):
                    has_waiting |= self._offer_own(
                        shared, subscription, sample.publisher, now_ns, more=more
                    )
        return has_waiting

    def _note_lost(self, lost: int) -> None:
        """Count samples that never came, and leave out their numbers."""
        new, self._lost = lost - self._lost, lost
        self._seq += new
        self._counts.lose(new)
        for encoding in self._encodings.values():
            for subscription in encoding.subscriptions:
                subscription.lose(new)

    def _time(self, received_ns: int) -> None:
        """Note how long it has taken until some of the clients, in turn, had their frames."""
        everyone = [one for each in self._encodings.values() for one in each.subscriptions]
        first = self._timed % max(1, len(everyone))
        self._timed += TIMED_AT_ONCE
        for subscription in (everyone[first:] + everyone[:first])[:TIMED_AT_ONCE]:
            subscription.sent_at_once(received_ns)

    def _wake_all(self) -> None:
        """Have the sessions of all subscriptions send what they can."""
        for encoding in self._encodings.values():
            for subscription in encoding.subscriptions:
                if subscription.session.outbox.size:
                    subscription.session.wake()

    def _offer_own(
        self,
        shared: SharedFrame,
        subscription: Subscription,
        publisher: bytes | None,
        now_ns: int,
        *,
        more: bool,
    ) -> bool:
        received_ns = self._ros.now_ns() if subscription.options.meta else None
        own = PerClientFrame(shared, subscription, received_ns)
        return subscription.offer(own, now_ns, more=more, publisher=publisher)

    def _join_late(self, subscription: Subscription) -> None:
        try:
            self._late_joins[subscription] = LateJoin(
                self._ros_subscription,
                partial(self._offer_late, subscription),
                partial(self._end_late_join, subscription),
            )
        except RosError as error:
            text = (
                f"{error}, so messages that {self.key.name} keeps for late subscribers are missing"
            )
            subscription.warn(ProtocolError(error.code, text))
        else:
            subscription.set_late(is_late=True)

    def _passes(self, subscription: Subscription, seq: int, sample: Sample) -> bool:
        join = self._late_joins.get(subscription)
        return join is None or join.passes(seq, sample)

    def _offer_late(self, subscription: Subscription, sample: Sample, seq: int | None) -> None:
        """Offer a sample to a late subscription. Retained ones have the number of the newest."""
        if subscription.source is None:
            return
        encoding = self._encodings[subscription.source.encoding]
        if seq is None:
            sample = sample._replace(received_ns=0)  # long ago
        shared = SharedFrame(encoding, sample, self._seq if seq is None else seq)
        self._offer_own(shared, subscription, sample.publisher, time.monotonic_ns(), more=True)
        subscription.session.wake()

    def _feeds(self, subscription: Subscription) -> bool:
        return any(subscription in each.subscriptions for each in self._encodings.values())

    def _end_late_join(self, subscription: Subscription) -> None:
        self._late_joins.pop(subscription).close()
        subscription.set_late(is_late=False)

    def _on_event(self, event: TopicEvent) -> None:
        """Warn the clients of what keeps messages from them."""
        self._report(event)
        for encoding in list(self._encodings.values()):
            for subscription in list(encoding.subscriptions):
                subscription.warn(warning(event, subscription.session))

    def _on_codec_error(self, key: EncodingKey, error: CodecError) -> None:
        """Warn those who get no sample, as it cannot be encoded for them. Within bounds."""
        if key not in self._encodings:
            return  # a worker has ended too late
        text = self._faults[key].note(f"{self.key.name}: {error}", time.monotonic_ns())
        if text is not None:
            self._warn(key, ProtocolError("invalid_value", text))

    def _warn(self, key: EncodingKey, error: ProtocolError) -> None:
        for subscription in list(self._encodings[key].subscriptions):
            subscription.warn(error)
