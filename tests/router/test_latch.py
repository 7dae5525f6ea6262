# SPDX-License-Identifier: Apache-2.0
from gateway.ports import Sample
from gateway.router import latch
from gateway.router.latch import Latch


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
