# SPDX-License-Identifier: Apache-2.0
"""Events that DDS counts for a subscription or a publisher: missed deadlines, lost messages.

rclpy hands these counts to an executor, which the gateway's nodes do not have. Here the loop looks
at them twice a second. A look costs 1 us for each count, and no thread of DDS waits for it.
"""

import asyncio
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

from gateway.config.limits import MAX_QUEUE_DEPTH
from gateway.sources.rclpy.rclpy_private.handles import (
    SubscriptionCount,
    missed_deadlines,
    subscription_count,
)
from gateway.sources.rclpy.samples import Reader
from gateway.sources.source import Qos, TopicEvent

LOOK_S: Final = 0.5
# A lasting problem is reported again after so long, with the number of times since.
REPEAT_NS: Final = 5_000_000_000


@dataclass(slots=True)
class _Count:
    """One count of rcl, and the words that it is reported with."""

    take: Callable[[], int]
    destroy: Callable[[], None]
    event: Callable[[int], TopicEvent]
    unreported: int = 0
    reported_ns: int | None = None


@dataclass(eq=False, slots=True)
class QosWatch:
    """The counts of one subscription or publisher."""

    _owner: "QosEvents"
    _on_event: Callable[[TopicEvent], None]
    _counts: list[_Count] = field(default_factory=list)

    def close(self) -> None:
        """Report nothing any more, before the entity is destroyed. Twice is harmless."""
        self._owner.forget(self)
        counts, self._counts = self._counts, []
        for count in counts:
            count.destroy()

    def look(self, now_ns: int) -> None:
        """Report what has been counted since, each kind once in `REPEAT_NS`."""
        for count in self._counts:
            if not self._counts:  # a callback has closed this
                return
            count.unreported += count.take()
            is_due = count.reported_ns is None or now_ns - count.reported_ns >= REPEAT_NS
            if count.unreported and is_due:
                times, count.unreported = count.unreported, 0
                count.reported_ns = now_ns
                self._on_event(count.event(times))


class QosEvents:
    """Looks at all watched counts, each `LOOK_S`, and not at all without any."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop
        self._open: dict[QosWatch, None] = {}
        self._timer: asyncio.TimerHandle | None = None

    def of_subscription(
        self, reader: Reader, topic: str, qos: Qos, on_event: Callable[[TopicEvent], None]
    ) -> QosWatch:
        """Watch a reader with a profile in force."""
        entity, lost = reader.entity, reader.lost
        take_lost, destroy = subscription_count(entity, "messages_lost")

        def take() -> int:
            return lost.take(by_dds=take_lost())

        counts = [_Count(take, destroy, lambda times: _messages_lost(topic, qos, times))]
        kinds: list[tuple[SubscriptionCount, Callable[[int], TopicEvent]]] = []
        if qos.deadline_ns is not None:
            late = f"no message within the deadline of {_ms(qos.deadline_ns)}"
            kinds.append(("deadline_missed", lambda times: _deadline(f"{topic}: {late}", times)))
        if qos.lease_ns is not None:
            kinds.append(("liveliness_lost", lambda times: _liveliness_lost(topic, times)))
        counts.extend(_Count(*subscription_count(entity, kind), event) for kind, event in kinds)
        return self._watch(on_event, counts)

    def of_publisher(
        self, entity: Any, topic: str, qos: Qos, on_event: Callable[[TopicEvent], None]
    ) -> QosWatch | None:
        """Watch rclpy's publisher. ``None`` if it has promised nothing that it could miss."""
        if qos.deadline_ns is None:
            return None
        late = f"nothing was published within the deadline of {_ms(qos.deadline_ns)}"
        take, destroy = missed_deadlines(entity)
        count = _Count(take, destroy, lambda times: _deadline(f"{topic}: {late}", times))
        return self._watch(on_event, [count])

    def forget(self, watch: QosWatch) -> None:
        """Look no longer at a watch. Others are ignored."""
        self._open.pop(watch, None)
        if not self._open and self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _watch(self, on_event: Callable[[TopicEvent], None], counts: Sequence[_Count]) -> QosWatch:
        watch = QosWatch(self, on_event, list(counts))
        self._open[watch] = None
        if self._timer is None:
            self._timer = self._loop.call_later(LOOK_S, self._look)
        return watch

    def _look(self) -> None:
        self._timer = self._loop.call_later(LOOK_S, self._look)
        now_ns = time.monotonic_ns()
        for watch in list(self._open):
            if watch in self._open:  # an earlier one may have closed it
                watch.look(now_ns)


def _deadline(what: str, times: int) -> TopicEvent:
    return TopicEvent("deadline_missed", f"topic {what}{_times(times)}")


def _messages_lost(topic: str, qos: Qos, times: int) -> TopicEvent:
    number = "a message was" if times == 1 else f"{times} messages were"
    remedy = "have it publish less"
    if qos.reliability != "reliable":
        asked = '"reliability":"reliable" in "qos"'
        remedy = f"ask for {asked} if its publishers offer that, or {remedy}"
    elif qos.depth is not None and qos.depth < MAX_QUEUE_DEPTH:
        depth = min(2 * qos.depth, MAX_QUEUE_DEPTH)
        remedy = f'ask for "depth":{depth} in "qos", or {remedy}'
    return TopicEvent("messages_lost", f"topic {topic}: {number} lost on the way here", remedy)


def _liveliness_lost(topic: str, times: int) -> TopicEvent:
    who = "a publisher has" if times == 1 else f"{times} publishers have"
    return TopicEvent("liveliness_lost", f"topic {topic}: {who} given no sign of life in time")


def _times(times: int) -> str:
    return f", {times} times" if times > 1 else ""


def _ms(nanoseconds: int) -> str:
    return f"{nanoseconds / 1e6:g} ms"
