# SPDX-License-Identifier: Apache-2.0
"""One sample to many clients, some of which are busy, slow, or want another frame."""

from collections.abc import Callable
from typing import Any

import pytest

from gateway.core.entries import NOT_READY, NOTHING, Frame
from gateway.core.names import TopicName
from gateway.core.requests import Subscribe
from gateway.core.topic_counts import TopicCounts
from gateway.core.topics.fan_out import Batch, write_directly
from gateway.core.topics.subscription import Subscription
from gateway.core.topics.subscription_options import SubscriptionOptions
from gateway.fronts.rosbridge.framing import RosbridgeFraming
from gateway.metrics.state import Delivery
from tests.core.conftest import lone_session

FRAME = b"a frame of a sample"


class Entry:
    """A sample that says how often its frame was asked for."""

    size = 1
    is_being_encoded = False
    arrived_ns = 0

    def __init__(self, frame: Frame = FRAME) -> None:
        self.asked = 0
        self._frame = frame

    def frame(self) -> Frame:
        self.asked += 1
        return self._frame


class Client:
    """A socket with room, and its subscription."""

    def __init__(self, **options: Any) -> None:
        self.written: list[bytes] = []
        self.room_bytes = 10 * len(FRAME)
        self.room_after_look = 0
        self.session = lone_session()
        self.session.outbox.connect(lambda _: 0, self)
        request = Subscribe(topic="/t", **{"framing": RosbridgeFraming(), **options})
        self.subscription = Subscription(
            *(self.session, "/t", TopicName("/t"), {None: request}),
            *(SubscriptionOptions.merge([request]), TopicCounts(), lambda _: None),
        )

    def write(self, frame: bytes) -> None:
        self.written.append(frame)

    def look(self) -> None:
        self.room_bytes = max(self.room_bytes, self.room_after_look)


def fan_out(entry: Entry, clients: list[Client]) -> list[Client]:
    """Return the clients that have got nothing."""
    others = write_directly(entry, [client.subscription for client in clients])
    return [client for client in clients if client.subscription in others]


def test_everyone_gets_the_same_bytes_which_are_counted_and_made_once():
    clients = [Client() for _ in range(3)]
    entry = Entry()
    assert fan_out(entry, clients) == []
    assert entry.asked == 1
    for client in clients:
        assert client.written == [FRAME]
        assert client.room_bytes == 9 * len(FRAME)
        sent = Delivery(offered=1, sent=1, sent_bytes=len(FRAME))
        assert client.subscription.delivery == sent


def nothing_left(client: Client) -> None:
    client.room_bytes = 0


def too_little_left(client: Client) -> None:
    client.room_bytes = len(FRAME) - 1


def waiting(client: Client) -> None:
    client.session.outbox.put_control(b"an answer")


def waiting_for_an_older_one(client: Client) -> None:
    client.subscription.queue.put(Entry(NOT_READY))
    assert client.session.outbox.take(1000) == []


def gone(client: Client) -> None:
    client.session.outbox.disconnect()


def ros_sharp(client: Client) -> None:
    client.session.reads_ascii_only = True


def late(client: Client) -> None:
    client.subscription.set_late(is_late=True)


def broken(client: Client) -> None:
    def write(_: bytes) -> None:
        raise RuntimeError

    client.write = write  # type: ignore[method-assign]


@pytest.mark.parametrize(
    "become", [nothing_left, too_little_left, waiting, gone, ros_sharp, late, broken]
)
@pytest.mark.parametrize("place", [0, 1, 2])
def test_a_busy_subscription_is_left_to_others_and_delays_no_other(
    become: Callable[[Client], None], place: int
):
    clients = [Client() for _ in range(3)]
    become(clients[place])
    room_bytes = clients[place].room_bytes
    assert fan_out(Entry(), clients) == [clients[place]]
    assert [client.written for client in clients if client is not clients[place]] == [[FRAME]] * 2
    assert clients[place].written == []
    assert clients[place].room_bytes == room_bytes
    assert clients[place].subscription.delivery == Delivery()


def test_a_sample_overtakes_pictures_that_are_not_ready_but_no_older_sample():
    clients = [Client(), Client()]
    for client in clients:
        other = client.session.outbox.open_queue(1, None)
        other.put(Entry(NOT_READY))
        assert client.session.outbox.take(1000) == []
    waiting_for_an_older_one(clients[1])
    assert fan_out(Entry(), clients) == [clients[1]]
    assert clients[0].written == [FRAME]


@pytest.mark.parametrize(
    "options",
    [{"throttle_ms": 1000}, {"meta": True}, {"framing": RosbridgeFraming(fragment_size=1000)}],
)
def test_a_subscription_with_another_pace_or_frame_is_left_to_others(options: dict[str, Any]):
    clients = [Client(), Client(**options)]
    assert fan_out(Entry(), clients) == [clients[1]]


def test_a_socket_that_a_write_fills_has_no_room_left():
    client = Client()

    def fill(frame: bytes) -> None:
        client.written.append(frame)
        client.room_bytes = min(client.room_bytes, 0)  # as a pause of the transport does

    client.write = fill  # type: ignore[method-assign]
    assert fan_out(Entry(), [client]) == []
    assert fan_out(Entry(), [client]) == [client]
    assert client.written == [FRAME]


def test_a_socket_with_too_little_room_is_written_if_its_link_has_drained():
    client = Client()
    too_little_left(client)
    client.room_after_look = len(FRAME)
    assert fan_out(Entry(), [client]) == []
    assert client.room_bytes == 0


def fan_out_batch(entries: list[Entry], clients: list[Client]) -> list[Client]:
    subscriptions = [client.subscription for client in clients]
    others = write_directly(Batch(entries), subscriptions, len(entries))
    return [client for client in clients if client.subscription in others]


def test_the_samples_of_a_turn_are_one_write_for_each_client():
    clients = [Client(), Client(queue_length=3)]
    assert fan_out_batch([Entry(b"a"), Entry(b"b"), Entry(b"c")], clients) == []
    sent = Delivery(offered=3, sent=3, sent_bytes=3)
    for client in clients:
        assert client.written == [b"abc"]
        assert client.subscription.delivery == sent


def test_of_more_samples_in_a_turn_than_a_queue_keeps_none_are_written_at_once():
    clients = [Client(queue_length=2), Client()]
    entries = [Entry() for _ in range(3)]
    assert fan_out_batch(entries, clients) == [clients[0]]
    assert len(clients[1].written) == 1


@pytest.mark.parametrize("frame", [NOT_READY, NOTHING])
def test_samples_of_a_turn_of_which_one_has_no_frame_are_left_to_others(frame: Frame):
    clients = [Client(), Client()]
    assert fan_out_batch([Entry(), Entry(frame)], clients) == clients
    assert clients[0].written == clients[1].written == []


@pytest.mark.parametrize(("more", "is_encoded"), [(0, True), (1, False)])
def test_more_than_64_kib_of_samples_in_a_turn_are_not_encoded_at_once(more: int, is_encoded: bool):
    entries = [Entry(), Entry()]
    entries[0].size = 64 * 1024 - 1 + more
    fan_out_batch(entries, [Client()])
    assert [entry.asked for entry in entries] == [is_encoded, is_encoded]


def test_options_that_change_later_count_from_then_on():
    client = Client()
    request = Subscribe(topic="/t", framing=RosbridgeFraming(), throttle_ms=1000)
    for asked, is_left in (
        ([request], True),
        ([Subscribe(topic="/t", framing=RosbridgeFraming())], False),
    ):
        client.subscription.change({None: asked[0]}, SubscriptionOptions.merge(asked))
        assert (fan_out(Entry(), [client]) == [client]) is is_left


@pytest.mark.parametrize("frame", [NOT_READY, NOTHING])
def test_a_sample_without_a_frame_is_left_to_others_and_not_asked_for_again(frame: Frame):
    clients = [Client(), Client()]
    entry = Entry(frame)
    assert fan_out(entry, clients) == clients
    assert entry.asked == 1
    assert clients[0].written == clients[1].written == []


def test_a_sample_is_not_encoded_if_no_subscription_can_take_it():
    clients = [Client(), Client()]
    for client in clients:
        nothing_left(client)
    entry = Entry()
    assert fan_out(entry, clients) == clients
    assert entry.asked == 0


def test_a_frame_that_cannot_be_made_for_a_bug_is_left_to_those_who_report_it():
    class Bug(Entry):
        def frame(self) -> Frame:
            raise ZeroDivisionError

    clients = [Client(), Client()]
    assert fan_out(Bug(), clients) == clients
