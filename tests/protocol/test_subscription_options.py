# SPDX-License-Identifier: Apache-2.0
from dataclasses import dataclass
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gateway.protocol.operations import Subscribe
from gateway.protocol.outbox import Outbox
from gateway.protocol.subscription_options import Stream, Wish

MS = 1_000_000


@dataclass
class Item:
    number: int
    size: int = 1
    is_being_rendered: bool = False

    def wire(self) -> bytes:
        return b"%d" % self.number


def wish(*requests: dict[str, Any]) -> Wish:
    return Wish.merge(
        Subscribe.model_validate({"topic": "/t", **request}) for request in requests or [{}]
    )


def run(stream: Stream, times_ms: list[float], outbox: Outbox) -> list[tuple[float, int]]:
    """Offer sample n at the n-th time; return when which sample was passed on."""
    passed: list[tuple[float, int]] = []
    release_ns: int | None = None

    def collect(now_ns: int) -> None:
        passed.extend((now_ns / MS, int(wire)) for wire in outbox.take(1 << 30))

    for number, time_ms in enumerate([*times_ms, 1e9]):
        now_ns = round(time_ms * MS)
        if release_ns is not None and release_ns <= now_ns:
            due_ns, release_ns = release_ns, None
            stream.release(due_ns)
            collect(due_ns)
        if number == len(times_ms):
            break
        due = stream.offer(Item(number), now_ns)
        release_ns = due if due is not None else release_ns
        collect(now_ns)
    return passed


def test_without_throttle_every_sample_passes():
    outbox = Outbox(1000)
    stream = Stream("/t", wish(), outbox)
    assert run(stream, [0, 1, 2], outbox) == [(0, 0), (1, 1), (2, 2)]


def test_throttle_passes_the_first_at_once_then_the_newest_of_each_interval_and_the_last():
    outbox = Outbox(1000)
    stream = Stream("/t", wish({"throttle_rate": 100}), outbox)
    passed = run(stream, [1000, 1010, 1050, 1090, 1120, 1130], outbox)
    assert passed == [(1000, 0), (1100, 3), (1200, 5)]
    assert stream.coalesced == 3


def test_a_sample_after_a_pause_passes_at_once():
    outbox = Outbox(1000)
    stream = Stream("/t", wish({"throttle_rate": 100}), outbox)
    assert run(stream, [1000, 5000], outbox) == [(1000, 0), (5000, 1)]


@given(
    st.lists(st.floats(0.01, 300), min_size=1, max_size=40),
    st.integers(1, 200),
)
def test_throttled_samples_keep_their_distance_and_the_last_one_arrives(gaps_ms, throttle_ms):
    times, now = [], 10_000.0
    for gap in gaps_ms:
        now += gap
        times.append(now)
    outbox = Outbox(1 << 20)
    stream = Stream("/t", wish({"throttle_rate": throttle_ms}), outbox)
    passed = run(stream, times, outbox)
    assert passed[-1][1] == len(times) - 1
    assert passed[0][1] == 0
    numbers = [number for _, number in passed]
    assert numbers == sorted(set(numbers))
    # on average never faster than asked for: a late sample does not slow the beat down
    assert (len(passed) - 2) * throttle_ms <= passed[-1][0] - passed[0][0] + 0.001
    assert len(passed) + stream.coalesced == len(times)


def test_several_subscriptions_merge_to_the_most_demanding():
    merged = wish(
        {"id": "a", "throttle_rate": 100, "queue_length": 5, "fields": ["pose"]},
        {"id": "b", "throttle_rate": 50, "queue_length": 2, "fields": ["twist", "pose"]},
    )
    assert merged.throttle_ns == 50 * MS
    assert merged.queue_length == 2
    assert merged.fields == ("pose", "twist")


def test_one_subscription_to_everything_gets_everything():
    assert wish({"fields": ["pose"]}, {"id": "b"}).fields is None
    assert wish({"throttle_rate": 100}, {"id": "b"}).throttle_ns == 0


@pytest.mark.parametrize(
    ("asked", "merged"),
    [
        (["none", None], "none"),
        ([None, "zip", ""], "none"),
        (["png", "none"], "png"),
        (["png", "cbor", "zip"], "cbor"),
        (["cbor", "cbor-raw", "png"], "cbor-raw"),
    ],
)
def test_the_strongest_compression_wins(asked, merged):
    requests = [{"id": number, "compression": one} for number, one in enumerate(asked)]
    assert wish(*requests).compression == merged


def test_the_smallest_fragments_win_and_none_are_the_default():
    assert wish().fragment_size is None
    assert wish({}, {"fragment_size": 2**31 - 1}, {"fragment_size": 64}).fragment_size == 64


@pytest.mark.parametrize(("max_fps", "throttle", "expected_ms"), [(10, 0, 100), (10, 200, 200)])
def test_max_fps_is_a_throttle_for_pictures(max_fps, throttle, expected_ms):
    merged = wish({"throttle_rate": throttle, "image": {"max_fps": max_fps}})
    assert merged.throttle_ns == expected_ms * MS


def test_queue_length_bounds_the_lane():
    outbox = Outbox(1000)
    stream = Stream("/t", wish({"queue_length": 3}), outbox)
    for number in range(10):
        stream.offer(Item(number), 0)
    assert outbox.take(1 << 30) == [b"7", b"8", b"9"]


def test_a_changed_wish_keeps_what_waits():
    outbox = Outbox(1000)
    stream = Stream("/t", wish(), outbox)
    stream.offer(Item(1), 0)
    stream.change(wish({"throttle_rate": 100}))
    assert outbox.take(1 << 30) == [b"1"]


def test_another_throttle_begins_at_once_and_keeps_the_order():
    outbox = Outbox(1000)
    stream = Stream("/t", wish({"throttle_rate": 3_600_000}), outbox)
    stream.offer(Item(1), 1000 * MS)
    stream.offer(Item(2), 1001 * MS)
    stream.change(wish({"throttle_rate": 10}))
    assert stream.offer(Item(3), 1002 * MS) is None
    assert stream.offer(Item(4), 1003 * MS) == 1012 * MS
    assert outbox.take(1 << 30) == [b"1", b"2", b"3"]
    stream.change(wish())
    stream.offer(Item(5), 1004 * MS)
    assert outbox.take(1 << 30) == [b"4", b"5"]
    stream.release(1012 * MS)
    assert outbox.take(1 << 30) == []


def test_the_same_throttle_goes_on():
    outbox = Outbox(1000)
    stream = Stream("/t", wish({"throttle_rate": 100}), outbox)
    stream.offer(Item(1), 0)
    stream.offer(Item(2), 1)
    stream.change(wish({"throttle_rate": 100, "meta": True}))
    assert outbox.take(1 << 30) == [b"1"]
    stream.release(100 * MS)
    assert outbox.take(1 << 30) == [b"2"]
