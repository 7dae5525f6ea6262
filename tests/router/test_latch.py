# SPDX-License-Identifier: Apache-2.0
import math

import pytest

from gateway.codec.types import Types
from gateway.ports import Sample
from gateway.router import latch
from gateway.router.latch import Latch, make_latch
from gateway.router.tf_listener import TF_MESSAGE
from schemas.installed import InstalledDefinitions, UnknownTypeError
from tests import interfaces


def samples(*texts: bytes) -> list[Sample]:
    return [Sample(text, 0) for text in texts]


def test_the_newest_samples_are_kept_with_their_numbers():
    kept = Latch()
    kept.keep(samples(b"a", b"b"), 1, count=2)
    kept.keep(samples(b"c"), 3, count=2)
    assert [(seq, sample.cdr) for seq, sample in kept.newest(5)] == [(2, b"b"), (3, b"c")]
    assert [seq for seq, _ in kept.newest(1)] == [3]


def test_bytes_are_bounded_but_one_sample_always_fits(monkeypatch):
    monkeypatch.setattr(latch, "MAX_BYTES", 10)
    kept = Latch()
    kept.keep(samples(b"1234", b"5678", b"9"), 1, count=9)
    assert [seq for seq, _ in kept.newest(9)] == [1, 2, 3]
    kept.keep(samples(b"ab"), 4, count=9)
    assert [seq for seq, _ in kept.newest(9)] == [2, 3, 4]
    kept.keep(samples(bytes(100)), 5, count=9)
    assert [seq for seq, _ in kept.newest(9)] == [5]


@pytest.fixture
def tf_type():
    try:
        return Types(InstalledDefinitions()).get(TF_MESSAGE)
    except UnknownTypeError:
        pytest.skip(interfaces.HOW)


def transforms(tf_type, **places):
    values = [
        {"child_frame_id": child, "transform": {"translation": {"x": x}}}
        for child, x in places.items()
    ]
    return Sample(tf_type.encode(tf_type.validate({"transforms": values}, 0)), 7)


def places(tf_type, sample):
    return {
        transform["child_frame_id"]: transform["transform"]["translation"]["x"]
        for transform in tf_type.decode(sample.cdr)["transforms"]
    }


def test_of_fixed_transforms_the_newest_of_each_child_is_kept_as_one_message(tf_type):
    kept = make_latch("/robot/tf_static", tf_type)
    kept.keep([transforms(tf_type, laser=1.0, camera=2.0)], 1, count=1)
    kept.keep([transforms(tf_type, arm=3.0), transforms(tf_type, camera=4.0)], 2, count=1)
    [(seq, sample)] = kept.newest(1)
    assert (seq, sample.received_ns) == (3, 7)
    assert places(tf_type, sample) == {"laser": 1.0, "arm": 3.0, "camera": 4.0}
    kept.keep([transforms(tf_type, laser=5.0)], 4, count=1)
    [(seq, sample)] = kept.newest(1)
    assert (seq, places(tf_type, sample)["laser"]) == (4, 5.0)
    kept.clear()
    assert kept.newest(1) == []


def test_fixed_transforms_are_bounded_and_what_is_no_message_harms_nothing(tf_type, monkeypatch):
    monkeypatch.setattr(latch, "MAX_FRAMES", 2)
    kept = make_latch("/tf_static", tf_type)
    kept.keep([transforms(tf_type, a=None, b=1.0), Sample(b"\0\1\0\0", 0)], 1, count=1)
    kept.keep([transforms(tf_type, a=None), transforms(tf_type, c=3.0)], 3, count=1)
    [(seq, sample)] = kept.newest(1)
    assert seq == 4
    kept_places = places(tf_type, sample)
    assert list(kept_places) == ["a", "c"]
    assert math.isnan(kept_places["a"])


def test_other_topics_keep_their_samples(tf_type):
    assert isinstance(make_latch("/tf", tf_type), Latch)
    strings = Types(InstalledDefinitions()).get("std_msgs/msg/String")
    assert isinstance(make_latch("/tf_static", strings), Latch)
