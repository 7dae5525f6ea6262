# SPDX-License-Identifier: Apache-2.0
from typing import Any

import pytest

from gateway.core.topics.subscription_options import SubscriptionOptions
from gateway.fronts.rosbridge.operations.topics import Subscribe

MS = 1_000_000

DEFAULT_QUEUE_LENGTH = 1024
DEFAULT_QUEUE_BYTES = 512 * 1024


def merged(*requests: dict[str, Any]) -> SubscriptionOptions:
    return SubscriptionOptions.merge(
        Subscribe.read({"topic": "/t", **request}).request() for request in requests or [{}]
    )


def test_several_requests_merge_to_the_most_demanding():
    options = merged(
        {"id": "a", "throttle_rate": 100, "queue_length": 5, "fields": ["pose"]},
        {"id": "b", "throttle_rate": 50, "queue_length": 2, "fields": ["twist", "pose"]},
    )
    assert options.pace.interval_ns == 50 * MS
    assert options.queue_length == 2
    assert options.fields == ("pose", "twist")


def test_the_newest_type_and_qos_win():
    options = merged({"type": "a/A", "qos": {"depth": 1}}, {"type": 9, "qos": {"depth": 2}}, {})
    assert options.type == 9
    assert options.qos.depth == 2


def test_one_request_for_everything_gets_everything():
    assert merged({"fields": ["pose"]}, {"id": "b"}).fields is None
    assert merged({"throttle_rate": 100}, {"id": "b"}).pace.interval_ns == 0


@pytest.mark.parametrize(
    ("asked", "strongest"),
    [
        (["none", None], "none"),
        ([None, "zip", ""], "none"),
        (["png", "none"], "png"),
        (["png", "cbor", "zip"], "cbor"),
        (["cbor", "cbor-raw", "png"], "cbor-raw"),
    ],
)
def test_the_strongest_compression_wins(asked, strongest):
    requests = [{"id": number, "compression": one} for number, one in enumerate(asked)]
    assert merged(*requests).framing.compression == strongest


def test_the_smallest_fragments_win_and_none_are_the_default():
    assert merged().framing.fragment_size is None
    options = merged({}, {"fragment_size": 2**31 - 1}, {"fragment_size": 64})
    assert options.framing.fragment_size == 64


@pytest.mark.parametrize(("max_fps", "throttle", "expected_ms"), [(10, 0, 100), (10, 200, 200)])
def test_max_fps_is_a_throttle_for_pictures(max_fps, throttle, expected_ms):
    options = merged({"throttle_rate": throttle, "image": {"max_fps": max_fps}})
    assert options.pace.interval_ns == expected_ms * MS


@pytest.mark.parametrize(
    ("request_", "is_own"),
    [
        ({}, False),
        ({"throttle_rate": 5}, False),
        ({"meta": True}, True),
        ({"fragment_size": 64}, True),
    ],
)
def test_meta_and_fragments_need_own_frames(request_, is_own):
    assert merged(request_).needs_own_frames == is_own
    assert merged({}, request_).needs_own_frames == is_own


def test_a_queue_is_bounded_as_requested_or_by_the_defaults():
    assert merged({"queue_length": 3}).queue_bounds == (3, None)
    assert merged().queue_bounds == (DEFAULT_QUEUE_LENGTH, DEFAULT_QUEUE_BYTES)


def test_a_queue_is_that_of_the_throttle_too_but_not_of_pictures_that_are_to_be_fresh():
    queued = {"throttle_rate": 100, "queue_length": 5}
    assert merged(queued).pace == (100 * MS, 5)
    assert merged({"throttle_rate": 100}).pace == (100 * MS, 1)
    assert merged(queued | {"image": {"max_fps": 5}}).pace == (200 * MS, 1)
    assert merged(queued | {"image": {"max_fps": 20}}).pace == (100 * MS, 5)
