# SPDX-License-Identifier: Apache-2.0
"""From DDS to the event loop: the data path."""

import asyncio
import contextlib
from collections.abc import Callable, Sequence
from typing import Any, Final

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile

from gateway.config.limits import MAX_QUEUE_DEPTH
from gateway.sources.rclpy.creating import group_of_one
from gateway.sources.rclpy.large_takes import (
    LARGE_SAMPLE_BYTES,
    LargeTake,
    LargeTakes,
    take_up_to,
)
from gateway.sources.rclpy.lost_samples import NO_NUMBER, LostSamples
from gateway.sources.rclpy.no_callbacks import NO_SUBSCRIPTION_EVENTS
from gateway.sources.rclpy.rclpy_private.handles import message_taker
from gateway.sources.rclpy.rclpy_private.takes import sample_taker
from gateway.sources.rclpy.ready_events import ReadyEvents
from gateway.sources.source import MAX_TAKES_PER_TURN, Sample

OnSamples = Callable[[Sequence[Sample]], None]
OnLost = Callable[[int], None]
"""Take the number of samples that never came, once that is known."""


def unheard(_: int) -> None:
    """Serve as `OnLost` where nobody asks."""


# as many as can be waiting when a flush begins. Later samples of a flood are not waited for
_TURNS_PER_FLUSH: Final = MAX_QUEUE_DEPTH // MAX_TAKES_PER_TURN


class Samples:
    """Readers of samples. No executor may spin their node."""

    def __init__(self, node: Node, ready_events: ReadyEvents) -> None:
        self.node = node
        self.ready_events = ready_events
        self.large_takes = LargeTakes()
        self.take_with_publisher = sample_taker()  # for the loop. Threads have their own

    def read(
        self,
        message_class: type,
        topic: str,
        profile: QoSProfile,
        on_samples: OnSamples,
        on_lost: OnLost = unheard,
    ) -> "Reader":
        """Create a subscription. Raises what rclpy raises."""
        return Reader(self, message_class, topic, profile, on_samples, on_lost)

    def close(self) -> None:
        """End the thread that takes large samples. To be called before the node is destroyed."""
        self.large_takes.close()


class Reader:
    """One rclpy subscription, whose samples the event loop takes.

    Those that may be large it has a thread take: the first of a topic that retains samples, as a
    map does, and those that follow a large one.
    """

    def __init__(
        self,
        samples: Samples,
        message_class: type,
        topic: str,
        profile: QoSProfile,
        on_samples: OnSamples,
        on_lost: OnLost,
    ) -> None:
        node = samples.node

        def create() -> Any:
            return node.create_subscription(
                message_class,
                topic,
                _never_called,
                profile,
                raw=True,
                callback_group=group_of_one(),
                event_callbacks=NO_SUBSCRIPTION_EVENTS,
            )

        self._large_takes = samples.large_takes
        self._take_with_publisher = samples.take_with_publisher
        self._tells_publishers = False
        self._loop = asyncio.get_running_loop()
        self._message_class = message_class
        self._on_samples = on_samples
        self._is_closed = False
        self._are_large = profile.durability == DurabilityPolicy.TRANSIENT_LOCAL
        self._large: LargeTake | None = None  # the thread is taking it
        self._asks_again = False  # more has arrived since
        self._source = samples.ready_events.open(
            "subscription", create, node.destroy_subscription, self._deliver, is_counted=False
        )
        self._subscription = self._source.entity
        self._take_message = message_taker(self._subscription)
        self.lost = LostSamples(self._subscription.get_publisher_count, on_lost)
        self._expected = NO_NUMBER  # of the next sample, while there is one publisher

    @property
    def topic_name(self) -> str:
        """The name that ROS gave the topic."""
        return str(self._subscription.topic_name)

    @property
    def publishers(self) -> int:
        """The number of publishers that it is matched with."""
        return int(self._subscription.get_publisher_count())

    @property
    def entity(self) -> Any:
        """The subscription as rclpy created it."""
        return self._subscription

    def deliver_to(self, on_samples: OnSamples, *, with_publishers: bool) -> None:
        """Deliver from now on to another callback, samples with the ids of their publishers or not.

        Without is faster.
        """
        self._on_samples = on_samples
        self._tells_publishers = with_publishers

    def close(self) -> None:
        """Deliver nothing any more and destroy the subscription. Closing twice is harmless."""
        self._is_closed = True
        large, self._large = self._large, None
        if large is not None:
            large.stop()  # rmw refuses another type for the topic while this one is in use
        self._source.close()

    def flush(self) -> None:
        """Deliver now all that is waiting, in as many calls as it takes. Closing ends it."""
        large, self._large = self._large, None
        if large is not None:
            self._finish(large.stop())
        for _ in range(_TURNS_PER_FLUSH):
            if self._is_closed or not (samples := self._take()):
                break
            self._on_samples(samples)

    def _deliver(self) -> None:
        # Before taking: a sample that arrives while we take brings the next turn.
        self._source.clear()
        if self._are_large:
            self._take_large()
            return
        samples = self._take()
        if samples:
            self._are_large = len(samples[-1].cdr) >= LARGE_SAMPLE_BYTES
            self._on_samples(samples)

    def _take(self) -> list[Sample]:
        """Take until empty, whatever was counted: one arrival may complete several samples.

        If rcl raises an error, the samples before it come first. The next take meets the error.
        """
        if self._tells_publishers:
            return self._take_with_publishers()
        take = self._take_message
        message_class = self._message_class
        expected = self._expected
        samples: list[Sample] = []
        try:
            while len(samples) < MAX_TAKES_PER_TURN:
                taken = take(message_class, True)  # True: raw
                if taken is None:
                    break
                cdr, info = taken
                received_ns, source_ns = info["received_timestamp"], info["source_timestamp"]
                number = info["publication_sequence_number"]
                if number != expected:
                    expected = self.lost.jump(expected, number)
                expected += 1
                samples.append(Sample(cdr, received_ns, source_ns, number))
            else:
                self._source.notify_again()  # there may be more
        except RuntimeError:
            if not samples:
                raise
            self._source.notify_again()
        self._expected = expected
        return samples

    def _take_with_publishers(self) -> list[Sample]:
        taken = take_up_to(
            MAX_TAKES_PER_TURN,
            lambda: self._take_with_publisher(self._subscription, self._message_class),
        )
        if taken.has_more:
            self._source.notify_again()
        return self._note_numbers(taken.samples)

    def _note_numbers(self, samples: list[Sample]) -> list[Sample]:
        for sample in samples:
            if sample.number != self._expected:
                self._expected = self.lost.jump(self._expected, sample.number)
            self._expected += 1
        return samples

    def _take_large(self) -> None:
        if self._large is not None:
            self._asks_again = True
            return
        self._asks_again = False
        self._large = self._large_takes.start(
            self._subscription, self._message_class, self._large_has_ended
        )

    def _large_has_ended(self) -> None:
        """Have the loop finish. On the thread that has taken, unless that was cancelled."""
        with contextlib.suppress(RuntimeError):  # the loop is closed
            self._loop.call_soon_threadsafe(self._finish_large)

    def _finish_large(self) -> None:
        large = self._large
        if large is None or not large.result.done():  # closed or flushed since
            return
        self._large = None
        # before the result, which may be an error: samples that have arrived are reported once
        if self._asks_again:
            self._source.notify_again()
        try:
            taken = large.result.result()
        except RuntimeError:
            self._are_large = False  # the loop tries
            self._source.notify_again()
            raise
        if taken.has_more:
            self._source.notify_again()
        self._finish(taken.samples)

    def _finish(self, samples: list[Sample]) -> None:
        """Deliver what the thread has taken."""
        if not samples:
            return
        self._note_numbers(samples)
        self._are_large = len(samples[-1].cdr) >= LARGE_SAMPLE_BYTES
        self._on_samples(samples)


def _never_called(*_: object) -> None:
    """Serve as the callback that rclpy asks for and nothing calls."""
