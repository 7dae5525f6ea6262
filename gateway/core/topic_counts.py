# SPDX-License-Identifier: Apache-2.0
"""The counts of each topic: they stay when the clients that caused them leave."""

from collections.abc import Iterable, Iterator
from typing import Final

from gateway.metrics.histogram import Histogram
from gateway.metrics.state import ClientPublication, ClientTopic, Delivery, TopicState

# Topics that nobody uses any more and whose counts are kept, 0.4 MB: those of a large robot. A
# client may use ever new names, so there is a bound. The one that was left first makes room.
MAX_UNUSED: Final = 256
NOTHING_DELIVERED: Final = Delivery()


class TopicCounts:
    """The counts of one topic. Those of what clients have open are added when it is closed."""

    __slots__ = (
        "delivery",
        "latency",
        "lost",
        "published",
        "published_bytes",
        "received",
        "received_bytes",
        "users",
    )

    def __init__(self) -> None:
        self.users = 0
        self.received = 0  # from ROS
        self.received_bytes = 0
        self.lost = 0  # on the way from ROS
        self.published = 0  # by clients
        self.published_bytes = 0
        self.delivery = NOTHING_DELIVERED
        self.latency = Histogram()

    def receive(self, count: int, size: int) -> None:
        """Count samples from ROS, and their bytes."""
        self.received += count
        self.received_bytes += size

    def lose(self, count: int) -> None:
        """Count samples that never came from ROS."""
        self.lost += count

    def publish(self, count: int, size: int = 0) -> None:
        """Count what a client has published that publishes no more."""
        self.published += count
        self.published_bytes += size

    def deliver(self, delivery: Delivery) -> None:
        """Add what a subscription had that has ended."""
        self.delivery = self.delivery.plus(delivery)

    @property
    def is_blank(self) -> bool:
        """True if nothing has passed: nobody misses it."""
        return not (self.received or self.published or self.delivery.offered)


class CountsByTopic:
    """The counts of all topics in use, and of the last ones that were."""

    def __init__(self) -> None:
        self._used: dict[str, TopicCounts] = {}
        self._unused: dict[str, TopicCounts] = {}  # left the longest ago first

    def open(self, topic: str) -> TopicCounts:
        """Return the counts of a topic, for one user more."""
        counts = self._used.get(topic)
        if counts is None:
            kept = self._unused.pop(topic) if topic in self._unused else TopicCounts()
            counts = self._used[topic] = kept
        counts.users += 1
        return counts

    def close(self, topic: str) -> None:
        """End the use of a topic by one who opened it, and has added what it did."""
        counts = self._used[topic]
        counts.users -= 1
        if counts.users:
            return
        del self._used[topic]
        if counts.is_blank:
            return
        self._unused[topic] = counts
        if len(self._unused) > MAX_UNUSED:
            del self._unused[next(iter(self._unused))]

    def states(
        self,
        client_topics: Iterable[ClientTopic],
        publications: Iterable[ClientPublication],
    ) -> Iterator[TopicState]:
        """Yield each topic with what clients that are there had of it, and those that have left."""
        deliveries: dict[str, list[Delivery]] = {}
        published: dict[str, list[ClientPublication]] = {}
        for each in client_topics:
            deliveries.setdefault(each.topic, []).append(each.delivery)
        for publication in publications:
            published.setdefault(publication.topic, []).append(publication)
        for topic, counts in (*self._used.items(), *self._unused.items()):
            delivery = counts.delivery
            for open_one in (ours := deliveries.get(topic, [])):
                delivery = delivery.plus(open_one)
            sent = published.get(topic, [])
            yield TopicState(
                topic=topic,
                received=counts.received,
                received_bytes=counts.received_bytes,
                lost=counts.lost,
                clients=len(ours),
                delivery=delivery,
                published=counts.published + sum(each.messages for each in sent),
                published_bytes=counts.published_bytes + sum(each.size for each in sent),
                latency=counts.latency.observed(),
            )
