# SPDX-License-Identifier: Apache-2.0
"""Every sample that is offered is sent, coalesced, dropped or pending: at every moment."""

import asyncio
from dataclasses import dataclass
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from gateway.config.limits import Limits
from gateway.core.entries import NOT_READY, NOTHING, Frame
from gateway.core.names import TopicName
from gateway.core.requests import Subscribe
from gateway.core.topic_counts import TopicCounts
from gateway.core.topics.fan_out import write_directly
from gateway.core.topics.subscription import Subscription
from gateway.core.topics.subscription_options import SubscriptionOptions
from gateway.fronts.rosbridge.framing import RosbridgeFraming
from gateway.metrics.histogram import NOTHING_OBSERVED
from gateway.metrics.state import Delivery
from tests.core.conftest import lone_session

LONG = 3_600_000
TIMED_EVERY = 16


@dataclass
class Item:
    """An entry that may not be ready, or never."""

    kind: str
    size: int = 10
    is_being_encoded: bool = False
    arrived_ns: int = 0

    def frame(self) -> Frame:
        if self.kind == "broken":
            return NOTHING
        return NOT_READY if self.kind == "not ready" else bytes(self.size)


class Client:
    """A session whose socket may be busy, and its subscription."""

    _room_bytes = 0

    def __init__(self, **options: Any) -> None:
        self.session = lone_session(Limits(send_queue_bytes=64 * 1024))
        self.session.outbox.max_bytes = 60
        self.session.outbox.connect(self._write_directly, self)
        self.counts = TopicCounts()
        self.subscription = Subscription(
            *(self.session, "/t", TopicName("/t"), *requested(**options)),
            *(self.counts, lambda _: None),
        )
        self.is_busy = False
        self.written = 0
        self.offered = 0

    @property
    def room_bytes(self) -> int:
        return 0 if self.is_busy else self._room_bytes

    @room_bytes.setter
    def room_bytes(self, size: int) -> None:
        self._room_bytes = size

    def write(self, frame: bytes) -> None:
        assert not self.is_busy
        assert not self.session.outbox.size
        self.written += 1

    def look(self) -> None:
        """Find no more room."""

    def _write_directly(self, entry: Any) -> int:
        frame = entry.frame()
        if self.is_busy or not isinstance(frame, bytes):
            return 0
        self.written += 1
        return len(frame)

    def take(self, size: int) -> None:
        self.written += len(self.session.outbox.take(size))

    def do(self, step: tuple[Any, ...]) -> None:
        match step:
            case ("offer", kind, more):
                self.offered += 1
                entry = Item(kind, is_being_encoded=kind == "not ready" and more)
                for rest in write_directly(entry, [self.subscription]):
                    rest.offer(entry, self.offered, more=more)
            case ("take", size):
                self.take(size)
            case ("busy", is_busy):
                self.is_busy = is_busy
            case ("room", size):
                self.room_bytes = size
            case ("interval",):
                self.subscription._on_interval()
            case ("change", options):
                self.subscription.change(*requested(**options))
            case ("clear",):
                self.subscription.clear()


def requested(**options: Any) -> tuple[dict[str | int | None, Subscribe], SubscriptionOptions]:
    request = Subscribe(topic="/t", framing=RosbridgeFraming(), **options)
    return {None: request}, SubscriptionOptions.merge([request])


def check(delivery: Delivery, client: Client) -> None:
    ended = delivery.sent + delivery.coalesced + delivery.dropped
    assert delivery.offered == ended + delivery.pending == client.offered
    assert delivery.sent == client.written
    assert delivery.sent_bytes == 10 * client.written


options = st.sampled_from(
    [
        {},
        {"queue_length": 1},
        {"queue_length": 3},
        {"throttle_ms": LONG},
        {"throttle_ms": 1},
        {"throttle_ms": LONG, "queue_length": 3},
    ]
)
steps = st.lists(
    st.one_of(
        st.tuples(
            st.just("offer"), st.sampled_from(["ready", "broken", "not ready"]), st.booleans()
        ),
        st.tuples(st.just("take"), st.sampled_from([5, 25, 1000])),
        st.tuples(st.just("busy"), st.booleans()),
        st.tuples(st.just("room"), st.sampled_from([0, 5, 25, 1000])),
        st.tuples(st.just("interval")),
        st.tuples(st.just("change"), options),
        st.tuples(st.just("clear")),
    ),
    max_size=80,
)


@given(steps, options)
def test_an_offered_sample_is_sent_coalesced_dropped_or_pending(steps, first):
    async def scenario() -> None:
        client = Client(**first)
        for step in steps:
            client.do(step)
            check(client.subscription.delivery, client)
        client.subscription.close()
        assert client.subscription.delivery.pending == 0
        check(client.counts.delivery, client)

    asyncio.run(scenario())


async def test_a_sample_that_a_worker_encodes_is_pending():
    client = Client()
    client.do(("offer", "not ready", True))
    client.take(1000)
    assert client.subscription.queue.claimed is not None
    assert client.subscription.delivery == Delivery(offered=1, pending=1)


async def test_counts_of_a_subscription_are_added_to_its_topic_when_it_ends():
    client = Client(throttle_ms=LONG)
    for _ in range(5):
        client.do(("offer", "ready", False))
    assert client.counts.delivery == Delivery()
    client.subscription.close()
    assert client.counts.delivery == Delivery(
        offered=5, sent=1, sent_bytes=10, coalesced=3, dropped=1
    )


async def test_counts_of_a_subscription_go_to_another_one_of_its_client_and_topic():
    first, other = Client(), Client()
    for client in (first, other):
        client.do(("offer", "ready", False))
    first.subscription.close(other.subscription)
    assert first.counts.delivery == Delivery()
    assert other.subscription.delivery == Delivery(offered=2, sent=2, sent_bytes=20)
    other.subscription.close()
    assert other.counts.delivery == Delivery(offered=2, sent=2, sent_bytes=20)


async def test_one_frame_in_sixteen_that_has_waited_is_timed_and_what_goes_at_once_when_asked():
    client = Client()
    client.is_busy = True
    for number in range(2 * TIMED_EVERY):
        client.subscription.offer(Item("not ready"), number, more=False)
        client.subscription.sent_at_once(1)  # it waits
    client.subscription.clear()
    assert client.counts.latency.observed() == NOTHING_OBSERVED
    for number in range(2 * TIMED_EVERY):
        client.subscription.offer(Item("ready", arrived_ns=1), number, more=False)
        client.session.outbox.take(1000)
    for observed in (client.counts.latency.observed(), client.session.latency.observed()):
        assert sum(observed.counts) == 2
    client.subscription.sent_at_once(1)
    assert sum(client.counts.latency.observed().counts) == 3
    late = Client()
    late.is_busy = True
    for number in range(TIMED_EVERY):  # as what a transient-local topic had kept
        late.subscription.offer(Item("ready"), number, more=False)
        late.session.outbox.take(1000)
    assert late.counts.latency.observed() == NOTHING_OBSERVED
