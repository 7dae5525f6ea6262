# SPDX-License-Identifier: Apache-2.0
"""From DDS to the event loop: the data path."""

from collections.abc import Callable, Sequence
from typing import Any, Final

from rclpy.node import Node
from rclpy.qos import QoSProfile

from gateway.config.limits import MAX_QUEUE_DEPTH
from gateway.ports import MAX_TAKES_PER_TURN, Sample
from gateway.ros import rclpy_private
from gateway.ros.groups import group_of_one
from gateway.ros.lost_samples import NO_NUMBER, LostSamples
from gateway.ros.ready_events import NO_EVENTS, ReadyEvents

OnSamples = Callable[[Sequence[Sample]], None]
OnLost = Callable[[int], None]
"""Take the number of samples that never came, once that is known."""


def unheard(_: int) -> None:
    """Serve as `OnLost` where nobody asks."""


# as many as can be waiting when a flush begins; what arrives during a flood is not waited for
_TURNS_PER_FLUSH: Final = MAX_QUEUE_DEPTH // MAX_TAKES_PER_TURN


class Samples:
    """Readers of samples; no executor may spin their node."""

    def __init__(self, node: Node, ready_events: ReadyEvents) -> None:
        self._node = node
        self._ready_events = ready_events

    def read(
        self,
        message_class: type,
        topic: str,
        profile: QoSProfile,
        on_samples: OnSamples,
        on_lost: OnLost = unheard,
    ) -> "Reader":
        """Create a subscription; raises what rclpy raises."""
        return Reader(
            self._node, self._ready_events, message_class, topic, profile, on_samples, on_lost
        )


class Reader:
    """One rclpy subscription, whose samples the event loop takes."""

    def __init__(
        self,
        node: Node,
        ready_events: ReadyEvents,
        message_class: type,
        topic: str,
        profile: QoSProfile,
        on_samples: OnSamples,
        on_lost: OnLost,
    ) -> None:
        def create() -> Any:
            return node.create_subscription(
                message_class,
                topic,
                _never_called,
                profile,
                raw=True,
                callback_group=group_of_one(),
                event_callbacks=NO_EVENTS,
            )

        self._message_class = message_class
        self._on_samples = on_samples
        self._is_closed = False
        self._source = ready_events.open(
            "subscription", create, node.destroy_subscription, self._deliver, is_counted=False
        )
        self._subscription = self._source.entity
        self._take_message = rclpy_private.message_taker(self._subscription)
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

    def close(self) -> None:
        """Deliver nothing any more and destroy the subscription. Closing twice is harmless."""
        self._is_closed = True
        self._source.close()

    def flush(self) -> None:
        """Deliver now all that is waiting, in as many calls as it takes; closing ends it."""
        for _ in range(_TURNS_PER_FLUSH):
            if self._is_closed or not (samples := self._take()):
                break
            self._on_samples(samples)

    def _deliver(self) -> None:
        # Before taking: a sample that arrives while we take brings the next turn.
        self._source.clear()
        samples = self._take()
        if len(samples) == MAX_TAKES_PER_TURN:
            self._source.notify_again()  # there may be more
        if samples:
            self._on_samples(samples)

    def _take(self) -> list[Sample]:
        """Take until empty, whatever was counted: one arrival may complete several samples."""
        take = self._take_message
        message_class = self._message_class
        expected = self._expected
        samples: list[Sample] = []
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
        self._expected = expected
        return samples


def _never_called(*_: object) -> None:
    """Serve as the callback that rclpy asks for and nothing calls."""
