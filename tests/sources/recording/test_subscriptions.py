# SPDX-License-Identifier: Apache-2.0
"""Messages for subscribers, and those that wait for late ones."""

import asyncio
from collections.abc import Sequence
from dataclasses import replace

import pytest

from gateway.sources.recording.subscriptions import RecordingSubscription, RecordingSubscriptions
from gateway.sources.recording.tracks import (
    DEFAULT_QOS,
    MAX_HELD,
    MAX_HELD_BYTES,
    TF_STATIC,
    Recorded,
    Track,
)
from gateway.sources.source import Sample

LATCHED = replace(DEFAULT_QOS, durability="transient_local", depth=1)


class Got(list[bytes]):
    def take(self, samples: Sequence[Sample]) -> None:
        self.extend(bytes(each.cdr) for each in samples)


def late(all_of_them: RecordingSubscriptions, track: Track) -> Got:
    got = Got()
    RecordingSubscription(all_of_them, track.stream, track.qos, got.take)
    return got


def messages(track: Track, *cdrs: bytes) -> list[Recorded]:
    return [Recorded(0, track, cdr) for cdr in cdrs]


@pytest.fixture
def everything() -> RecordingSubscriptions:
    return RecordingSubscriptions(())


async def test_the_last_message_of_each_publisher_is_held(
    everything: RecordingSubscriptions,
) -> None:
    one, other = (Track("/map", "pkg/msg/Map", LATCHED) for _ in range(2))
    everything.play([*messages(one, b"1", b"2"), *messages(other, b"3"), *messages(one, b"4")])
    got = late(everything, one)
    await asyncio.sleep(0)
    assert got == [b"3", b"4"]


async def test_static_transforms_are_held_whatever_depth_was_offered(
    everything: RecordingSubscriptions,
) -> None:
    track = Track(TF_STATIC, "tf2_msgs/msg/TFMessage", LATCHED)
    cdrs = [str(number).encode() for number in range(MAX_HELD + 3)]
    everything.play(messages(track, *cdrs))
    got = late(everything, track)
    await asyncio.sleep(0)
    assert got == cdrs[3:]


async def test_held_messages_have_bounds(everything: RecordingSubscriptions) -> None:
    deep = Track("/log", "pkg/msg/Log", replace(LATCHED, depth=10 * MAX_HELD))
    everything.play(messages(deep, *[b"x"] * (MAX_HELD + 1)))
    large = Track("/scene", "pkg/msg/Scene", replace(LATCHED, depth=50))
    cdr = bytes(MAX_HELD_BYTES // 4)
    everything.play(messages(large, *[cdr] * 9))
    assert len(late_of(everything, deep)) == MAX_HELD
    assert len(late_of(everything, large)) == 4


def late_of(everything: RecordingSubscriptions, track: Track) -> list[Sample]:
    (newest,) = everything._held[track.stream].values()
    return list(newest.messages)


async def test_played_messages_do_not_overtake_held_ones(
    everything: RecordingSubscriptions,
) -> None:
    track = Track("/map", "pkg/msg/Map", replace(LATCHED, depth=5))
    everything.play(messages(track, b"1", b"2"))
    got = late(everything, track)
    everything.play(messages(track, b"3"))
    await asyncio.sleep(0)
    everything.play(messages(track, b"4"))
    assert got == [b"1", b"2", b"3", b"4"]


async def test_a_subscription_that_is_closed_at_once_gets_nothing(
    everything: RecordingSubscriptions,
) -> None:
    track = Track("/map", "pkg/msg/Map", LATCHED)
    everything.play(messages(track, b"1"))
    got = Got()
    RecordingSubscription(everything, track.stream, track.qos, got.take).close()
    await asyncio.sleep(0)
    assert got == []
    assert not everything.has(track.stream)
