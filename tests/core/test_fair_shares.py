# SPDX-License-Identifier: Apache-2.0
"""The shares of a link that is too slow for everything."""

from collections import Counter
from dataclasses import dataclass
from unittest.mock import Mock

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gateway.core.outbox import Outbox
from gateway.core.queue import Queue

LENGTH = 100
ROOM = 256 * 1024
LARGE_FRAME_BYTES = 4096
LARGE_SHARE = 0.2
FRESH_BYTES = 2000  # of small messages that a link of 50 kB/s drains in 50 ms


@dataclass
class Message:
    """An entry of some topic, larger or smaller as a frame than as it waits."""

    topic: int
    number: int
    size: int
    length: int
    is_being_encoded: bool = False
    arrived_ns: int = 0

    def frame(self) -> bytes:
        return (b"%d %d " % (self.topic, self.number)).ljust(self.length, b".")


def message(topic: int, number: int = 0, size: int = 700, length: int | None = None) -> Message:
    return Message(topic, number, size, length or size)


def read(frame: bytes) -> tuple[int, int]:
    topic, number, *_ = frame.split()
    return int(topic), int(number)


class Topics:
    """Topics that always have something to send, to one client."""

    def __init__(self, *sizes: int) -> None:
        self.outbox = Outbox(1 << 30)
        self.queues = [self.outbox.open_queue(LENGTH, None) for _ in sizes]
        self.sizes = sizes
        self.got: Counter[int] = Counter()

    def send(self, total: int, chunk: int = 1) -> None:
        while total > 0:
            for topic, (queue, size) in enumerate(zip(self.queues, self.sizes, strict=True)):
                while len(queue.waiting) < 5:
                    queue.put(message(topic, size=size))
            for frame in self.outbox.take(chunk):
                self.got[read(frame)[0]] += len(frame)
                total -= len(frame)


def test_small_topics_have_equal_shares_by_bytes_and_not_by_frames():
    topics = Topics(3000, 300)
    topics.send(1_000_000)
    assert abs(topics.got[0] - topics.got[1]) <= 2 * 3000


def test_large_topics_have_a_fifth_of_a_link_that_small_ones_would_fill():
    topics = Topics(700, 700, 45_000)
    topics.send(10_000_000)
    assert abs(topics.got[2] / 10_000_000 - LARGE_SHARE) < 0.02
    assert abs(topics.got[0] - topics.got[1]) <= 2 * 700


def test_many_small_topics_leave_the_large_one_its_share():
    topics = Topics(*[LARGE_FRAME_BYTES] * 20, LARGE_FRAME_BYTES + 1)
    topics.send(1_000_000)
    assert abs(topics.got[20] / 1_000_000 - LARGE_SHARE) < 0.02


@given(
    st.lists(st.integers(400, LARGE_FRAME_BYTES), min_size=1, max_size=6),
    st.lists(st.integers(LARGE_FRAME_BYTES + 1, 60_000), max_size=3),
    st.integers(1, 2000),  # five of the smallest: all topics have so much to send
)
def test_a_busy_queue_gets_its_share(small, large, chunk):
    topics = Topics(*small, *large)
    topics.send(10 * (sum(small) + sum(large)), chunk)
    got = [topics.got[topic] for topic in range(len(topics.sizes))]
    of_small, of_large = got[: len(small)], got[len(small) :]
    assert max(of_small) - min(of_small) <= 2 * max(small)
    if large:
        assert max(of_large) - min(of_large) <= 2 * max(large)
        behind = sum(of_small) / (1 - LARGE_SHARE) - sum(of_large) / LARGE_SHARE
        assert abs(behind) <= 2 * (max(small) / (1 - LARGE_SHARE) + max(large) / LARGE_SHARE)


def test_a_kind_that_had_nothing_to_send_for_long_is_owed_nothing():
    topics = Topics(45_000)
    topics.send(10_000_000)
    topics.queues.append(topics.outbox.open_queue(LENGTH, None))
    topics.sizes = (45_000, 700)
    topics.got.clear()
    topics.send(5_000_000)
    assert abs(topics.got[0] / 5_000_000 - LARGE_SHARE) < 0.02


def test_a_small_topic_that_has_less_to_send_than_its_share_waits_for_one_frame_at_most():
    outbox = Outbox(1 << 30)
    picture, state = outbox.open_queue(LENGTH, None), outbox.open_queue(LENGTH, None)
    for number in range(50):
        picture.put(message(0, number, 45_000))
    for number in range(20):
        state.put(message(1, number))
        first, *_ = outbox.take(1)
        assert read(first) == (1, number)
        outbox.take(1)


def test_a_queue_that_was_idle_for_long_is_owed_nothing():
    topics = Topics(700, 700)
    queue = topics.queues.pop()
    topics.sizes = (700,)
    topics.send(100_000)
    topics.queues.append(queue)
    topics.sizes = (700, 700)
    topics.got.clear()
    topics.send(100_000)
    assert abs(topics.got[0] - topics.got[1]) <= 2 * 700


@pytest.mark.parametrize(("before", "after"), [(8000, 700), (700, 8000)])
def test_a_topic_that_becomes_smaller_or_larger_has_its_turn_by_that(before: int, after: int):
    topics = Topics(before)
    topics.send(10_000_000)
    queue = topics.queues[0]
    queue.clear()
    topics.queues.append(topics.outbox.open_queue(LENGTH, None))
    topics.sizes = (after, after)
    topics.got.clear()
    topics.send(1_000_000)
    assert abs(topics.got[0] - topics.got[1]) <= 2 * after


def fresh(bytes_per_s: float, depth: int = LENGTH, room: int | None = ROOM) -> tuple[Outbox, Queue]:
    outbox = Outbox(1 << 30)
    outbox.drains(bytes_per_s)
    return outbox, outbox.open_queue(depth, room)


def test_old_entries_on_a_slow_link_make_room_for_newer_ones():
    outbox, queue = fresh(50_000)
    for number in range(LENGTH):
        queue.put(message(0, number, 500))
    kept = 1 + FRESH_BYTES // 500
    numbers = [read(frame)[1] for frame in outbox.take(1 << 30)]
    assert numbers == list(range(LENGTH))[-kept:]
    assert queue.dropped == LENGTH - kept


def test_the_frames_count_and_not_what_they_are_made_of():
    outbox, queue = fresh(50_000)
    queue.put(message(0, 0, 100, 1000))
    outbox.take(1)  # frames are ten times as long
    for number in range(LENGTH):
        queue.put(message(0, number, 100, 1000))
    outbox.take(1)
    assert len(queue.waiting) == FRESH_BYTES // 1000


def test_the_newest_is_kept_on_however_slow_a_link():
    outbox, queue = fresh(1.0)
    for number in range(3):
        queue.put(message(0, number, 100_000))
    assert [read(frame) for frame in outbox.take(1)] == [(0, 2)]


def test_a_length_that_a_client_has_asked_for_holds_on_a_slow_link_too():
    outbox, queue = fresh(50_000, room=None)
    for number in range(LENGTH):
        queue.put(message(0, number))
    assert len(outbox.take(1 << 30)) == LENGTH
    assert queue.dropped == 0


def test_of_what_is_said_once_nothing_is_dropped_for_being_old():
    outbox = Outbox(1 << 30)
    outbox.drains(50_000)
    queue = outbox.open_queue(LENGTH, ROOM, Mock(is_latched=lambda: True))
    for number in range(LENGTH):
        queue.put(message(0, number))
    assert len(outbox.take(1 << 30)) == LENGTH


def test_on_a_link_that_was_never_full_everything_waits():
    outbox = Outbox(1 << 30)
    queue = outbox.open_queue(LENGTH, ROOM)
    for number in range(LENGTH):
        queue.put(message(0, number))
    assert len(outbox.take(1 << 30)) == LENGTH
    assert queue.dropped == 0


def test_of_several_the_one_with_most_loses():
    outbox, talkative = fresh(50_000)
    rare = outbox.open_queue(LENGTH, ROOM)
    for number in range(2):
        rare.put(message(1, number))
    for number in range(LENGTH):
        talkative.put(message(0, number))
    outbox.take(1)
    assert rare.dropped == 0
    assert talkative.dropped > 0


@given(
    puts=st.lists(
        st.tuples(st.integers(0, 3), st.integers(1, 50_000), st.integers(1, 50_000)), max_size=120
    ),
    takes=st.lists(st.integers(1, 60_000), min_size=1, max_size=40),
    bytes_per_s=st.none() | st.floats(1.0, 1e8),
    data=st.data(),
)
def test_nothing_is_reordered_lost_unseen_or_left(
    puts: list[tuple[int, int, int]],
    takes: list[int],
    bytes_per_s: float | None,
    data: st.DataObject,
):
    outbox = Outbox(200_000)
    if bytes_per_s is not None:
        outbox.drains(bytes_per_s)
    bounds = [(LENGTH, ROOM), (LENGTH, ROOM), (10, None), (1, None)]
    queues = [outbox.open_queue(*each) for each in bounds]
    offered: Counter[int] = Counter()
    seen: dict[int, list[int]] = {topic: [] for topic in range(4)}

    def take(most: int) -> None:
        taken = outbox.take(most)
        assert taken or not outbox.size
        assert sum(map(len, taken[:-1])) < most
        for frame in taken:
            topic, number = read(frame)
            seen[topic].append(number)

    for number, (topic, size, length) in enumerate(puts):
        queues[topic].put(message(topic, number, size, length))
        offered[topic] += 1
        assert outbox.size <= outbox.max_bytes or sum(queue.pending for queue in queues) == 1
        if data.draw(st.booleans()):
            take(takes[number % len(takes)])
    while outbox.size:
        take(takes[0])
    for topic, queue in enumerate(queues):
        assert seen[topic] == sorted(seen[topic])
        assert len(seen[topic]) + queue.dropped == offered[topic]
        newest = max((number for number, (each, *_) in enumerate(puts) if each == topic), default=0)
        assert not seen[topic] or bytes_per_s is None or seen[topic][-1] == newest
