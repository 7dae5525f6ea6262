# SPDX-License-Identifier: Apache-2.0
"""From DDS to the event loop: the data path.

`EventfdSamples` is the fast one: an eventfd wakes the loop, which takes the samples itself.
`ExecutorSamples` needs nothing but rclpy, and an executor that spins its node in a thread.
"""

import asyncio
from collections import deque
from collections.abc import Callable, Sequence
from typing import Any, Final, Protocol

from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import QoSProfile

from gateway.config.limits import MAX_QUEUE_DEPTH
from gateway.ports import MAX_TAKES_PER_TURN, Sample
from gateway.ros import rclpy_private
from gateway.ros.groups import group_of_one
from gateway.ros.ready_events import EventfdReadyEvents

OnSamples = Callable[[Sequence[Sample]], None]

# as many as can be waiting when a flush begins; what arrives during a flood is not waited for
_TURNS_PER_FLUSH: Final = MAX_QUEUE_DEPTH // MAX_TAKES_PER_TURN


class Reader(Protocol):
    """One rclpy subscription whose samples come to the event loop."""

    @property
    def topic_name(self) -> str:
        """The name that ROS gave the topic."""

    @property
    def publishers(self) -> int:
        """The number of publishers that it is matched with."""

    @property
    def entity(self) -> Any:
        """The subscription as rclpy created it."""

    def flush(self) -> None:
        """Deliver now all that is waiting, in as many calls as it takes; closing ends it."""

    def close(self) -> None:
        """Deliver nothing any more and destroy the subscription. Closing twice is harmless."""


class Samples(Protocol):
    """A way to bring samples to the event loop."""

    def read(
        self, message_class: type, topic: str, profile: QoSProfile, on_samples: OnSamples
    ) -> Reader:
        """Create a subscription; raises what rclpy raises."""


class EventfdSamples:
    """Readers whose samples the event loop takes by itself; no executor may spin their node."""

    def __init__(self, node: Node, ready_events: EventfdReadyEvents) -> None:
        self._node = node
        self._ready_events = ready_events

    def read(
        self, message_class: type, topic: str, profile: QoSProfile, on_samples: OnSamples
    ) -> Reader:
        """Create a subscription; raises what rclpy raises."""
        return _EventfdReader(
            self._node, self._ready_events, message_class, topic, profile, on_samples
        )


class _EventfdReader:
    def __init__(
        self,
        node: Node,
        ready_events: EventfdReadyEvents,
        message_class: type,
        topic: str,
        profile: QoSProfile,
        on_samples: OnSamples,
    ) -> None:
        def create() -> Any:
            return node.create_subscription(
                message_class,
                topic,
                _never_called,
                profile,
                raw=True,
                callback_group=group_of_one(),
                event_callbacks=_no_events(),
            )

        self._message_class = message_class
        self._on_samples = on_samples
        self._is_closed = False
        self._source = ready_events.open(
            "subscription", create, node.destroy_subscription, self._deliver, is_counted=False
        )
        self._subscription = self._source.entity
        self._take_message = rclpy_private.message_taker(self._subscription)

    @property
    def topic_name(self) -> str:
        return str(self._subscription.topic_name)

    @property
    def publishers(self) -> int:
        return int(self._subscription.get_publisher_count())

    @property
    def entity(self) -> Any:
        return self._subscription

    def close(self) -> None:
        self._is_closed = True
        self._source.close()

    def flush(self) -> None:
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
        samples: list[Sample] = []
        while len(samples) < MAX_TAKES_PER_TURN:
            taken = take(message_class, True)  # True: raw
            if taken is None:
                break
            cdr, info = taken
            received_ns, source_ns = info["received_timestamp"], info["source_timestamp"]
            number = info["publication_sequence_number"]
            samples.append(Sample(cdr, received_ns, source_ns, number))
        return samples


class ExecutorSamples:
    """Readers whose samples an executor's thread takes and hands over."""

    def __init__(self, node: Node, loop: asyncio.AbstractEventLoop) -> None:
        self._node = node
        self._loop = loop

    def read(
        self, message_class: type, topic: str, profile: QoSProfile, on_samples: OnSamples
    ) -> Reader:
        """Create a subscription; raises what rclpy raises."""
        return _ExecutorReader(self._node, self._loop, message_class, topic, profile, on_samples)


class _ExecutorReader:
    def __init__(
        self,
        node: Node,
        loop: asyncio.AbstractEventLoop,
        message_class: type,
        topic: str,
        profile: QoSProfile,
        on_samples: OnSamples,
    ) -> None:
        self._node = node
        self._loop = loop
        self._on_samples = on_samples
        # DDS' own queue is always empty here, so this one drops the oldest in its stead.
        self._waiting: deque[Sample] = deque(maxlen=profile.depth)
        self._is_scheduled = False
        self._is_closed = False
        arrive: Any = self._arrive  # rclpy's annotation knows callbacks without info only
        self._subscription = node.create_subscription(
            message_class,
            topic,
            arrive,
            profile,
            raw=True,
            callback_group=group_of_one(),
            event_callbacks=_no_events(),
        )

    @property
    def topic_name(self) -> str:
        return str(self._subscription.topic_name)

    @property
    def publishers(self) -> int:
        return int(self._subscription.get_publisher_count())

    @property
    def entity(self) -> Any:
        return self._subscription

    def close(self) -> None:
        if not self._is_closed:
            self._is_closed = True
            self._node.destroy_subscription(self._subscription)
            self._waiting.clear()

    def _arrive(self, cdr: bytes, info: dict[str, int]) -> None:
        """Keep one sample for the loop; runs on the executor's thread."""
        received_ns, source_ns = info["received_timestamp"], info["source_timestamp"]
        number = info["publication_sequence_number"]
        self._waiting.append(Sample(cdr, received_ns, source_ns, number))
        if not (self._is_scheduled or self._is_closed):
            self._is_scheduled = True
            self._loop.call_soon_threadsafe(self._deliver)

    def flush(self) -> None:
        for _ in range(_TURNS_PER_FLUSH):
            if self._is_closed or not (samples := self._take()):
                break
            self._on_samples(samples)

    def _deliver(self) -> None:
        if self._is_closed:
            return
        # Before looking: a sample that arrives while we look schedules the next turn.
        self._is_scheduled = False
        if len(self._waiting) > MAX_TAKES_PER_TURN:
            self._is_scheduled = True
            self._loop.call_soon(self._deliver)
        samples = self._take()
        if samples:
            self._on_samples(samples)

    def _take(self) -> list[Sample]:
        waiting = self._waiting
        return [waiting.popleft() for _ in range(min(len(waiting), MAX_TAKES_PER_TURN))]


def _no_events() -> SubscriptionEventCallbacks:
    # rclpy's callbacks need an executor: see `gateway.ros.qos_events`.
    return SubscriptionEventCallbacks(use_default_callbacks=False)


def _never_called(*_: object) -> None:
    """Serve as the callback that rclpy asks for and nothing calls."""
