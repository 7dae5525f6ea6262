# SPDX-License-Identifier: Apache-2.0
import logging
import math
import struct

import pytest

from gateway.codec.types import Types
from gateway.codec.validation import InvalidValueError
from gateway.ports import Sample
from gateway.router.topics import latch
from gateway.router.topics.latch import Latch, make_latch
from gateway.tf import TF_MESSAGE
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


def test_eight_mebibytes_are_kept():
    kept = Latch()
    for seq in range(1, 20):
        kept.keep(samples(bytes(1024**2)), seq, count=100)
    assert [seq for seq, _ in kept.newest(100)] == list(range(12, 20))


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
    return Sample(tf_type.encode({"transforms": values}, 0), 7)


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
    assert (seq, places(tf_type, sample)) == (4, {"arm": 3.0, "camera": 4.0, "laser": 5.0})
    kept.clear()
    assert kept.newest(1) == []


def test_fixed_transforms_of_512_frames_are_kept(tf_type):
    kept = make_latch("/tf_static", tf_type)
    for number in range(514):
        kept.keep([transforms(tf_type, **{f"frame_{number}": 1.0})], number, count=1)
    [(_, sample)] = kept.newest(1)
    assert list(places(tf_type, sample)) == [f"frame_{number}" for number in range(2, 514)]


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


@pytest.mark.parametrize(
    ("sec", "nanosec", "told"),
    [(1, 10**9, (2, 0)), (1, 2**32 - 1, (5, 294_967_295)), (2**31 - 1, 10**9, (2**31 - 1, 0))],
)
def test_a_stamp_with_too_many_nanoseconds_is_told_as_what_it_is(tf_type, sec, nanosec, told):
    stamp = {"sec": sec, "nanosec": 999_999_999}
    stamped = {"header": {"stamp": stamp, "frame_id": "base"}, "child_frame_id": "laser"}
    cdr = tf_type.encode({"transforms": [stamped]}, 0)
    broken = cdr.replace(struct.pack("<I", 999_999_999), struct.pack("<I", nanosec))
    kept = make_latch("/tf_static", tf_type)
    kept.keep([Sample(broken, 0)], 1, count=1)
    [(_, sample)] = kept.newest(1)
    [transform] = tf_type.decode(sample.cdr)["transforms"]
    assert tuple(transform["header"]["stamp"].values()) == told


def test_infinities_are_told_as_nan(tf_type):
    cdr = transforms(tf_type, laser=1.25).cdr
    endless = cdr.replace(struct.pack("<d", 1.25), struct.pack("<d", math.inf))
    kept = make_latch("/tf_static", tf_type)
    kept.keep([Sample(endless, 0)], 1, count=1)
    [(_, sample)] = kept.newest(1)
    assert math.isnan(places(tf_type, sample)["laser"])


def test_frames_with_absurd_names_are_not_kept(tf_type):
    kept = make_latch("/tf_static", tf_type)
    kept.keep([transforms(tf_type, laser=1.0, **{"x" * 257: 2.0, "y" * 256: 3.0})], 1, count=1)
    values = {"child_frame_id": "camera", "header": {"frame_id": "z" * 257}}
    cdr = tf_type.encode({"transforms": [values]}, 0)
    kept.keep([Sample(cdr, 0)], 2, count=1)
    [(_, sample)] = kept.newest(1)
    assert places(tf_type, sample) == {"laser": 1.0, "y" * 256: 3.0}


def test_where_no_message_can_be_made_the_latest_goes_out_and_the_log_says_so(
    tf_type, monkeypatch, caplog
):
    def refuse(values, now_ns):
        raise InvalidValueError("msg", "msg: expected something else")

    kept = make_latch("/tf_static", tf_type)
    latest = transforms(tf_type, camera=2.0)
    kept.keep([transforms(tf_type, laser=1.0), latest], 1, count=1)
    monkeypatch.setattr(tf_type, "encode", refuse)
    with caplog.at_level(logging.WARNING):
        for _ in range(2):
            assert kept.newest(1) == [(2, latest)]
    [record] = caplog.records
    assert "expected something else; the latest goes out alone" in record.getMessage()


def test_other_topics_keep_their_samples(tf_type):
    assert isinstance(make_latch("/tf", tf_type), Latch)
    strings = Types(InstalledDefinitions()).get("std_msgs/msg/String")
    assert isinstance(make_latch("/tf_static", strings), Latch)
