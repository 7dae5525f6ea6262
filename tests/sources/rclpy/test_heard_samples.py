# SPDX-License-Identifier: Apache-2.0
"""Comparing the samples of two readers. The contract suite tries it with real ones."""

from gateway.sources.rclpy import heard_samples
from gateway.sources.rclpy.heard_samples import HeardSamples
from gateway.sources.source import Sample


def samples(publisher: bytes, *numbers: int, size: int = 1) -> list[Sample]:
    return [Sample(bytes(size), 0, 0, number, publisher) for number in numbers]


def numbers(found: list[Sample]) -> list[int | None]:
    return [sample.number for sample in found]


def test_the_first_of_a_publisher_waits_for_what_the_new_reader_gets_before_it():
    heard = HeardSamples()
    assert numbers(heard.new(samples(b"a", 1, 2))) == [1, 2]
    heard.begin(is_latched=True, repaired=frozenset())
    assert numbers(heard.retired([*samples(b"a", 3), *samples(b"b", 3, 4, 6)])) == [3]
    assert numbers(heard.new([*samples(b"a", 1, 2, 3), *samples(b"b", 1, 2, 3)])) == [1, 2, 3]
    assert numbers(heard.retired(samples(b"b", 7))) == []
    assert numbers(heard.new(samples(b"b", 5))) == [4, 5]
    assert numbers(heard.end()) == [6, 7]
    assert numbers(heard.new(samples(b"b", 6, 7, 8))) == [8]


def test_samples_after_a_gap_wait_for_a_retired_reader_that_is_behind():
    heard = HeardSamples()
    heard.begin(is_latched=False, repaired=frozenset({b"a"}))
    assert numbers(heard.new([*samples(b"a", 5), *samples(b"b", 5)])) == [5]  # b is best effort
    assert numbers(heard.retired(samples(b"a", 2, 3))) == [2, 3]
    assert numbers(heard.new(samples(b"a", 4, 6))) == [4]
    assert numbers(heard.retired(samples(b"a", 4, 6))) == [5, 6]
    assert numbers(heard.new(samples(b"a", 8, 9))) == []
    assert numbers(heard.end()) == [8, 9]
    assert numbers(heard.new(samples(b"a", 11))) == [11]  # nobody gets 10 any more


def test_of_a_publisher_that_retains_its_first_samples_nothing_waits_for_the_retired_reader():
    heard = HeardSamples()
    heard.begin(is_latched=True, repaired=frozenset({b"a"}))
    assert numbers(heard.retired(samples(b"a", 2, 3))) == []
    assert numbers(heard.new(samples(b"a", 1))) == [1]
    assert numbers(heard.new(samples(b"a", 3))) == [2, 3]


def test_the_first_sample_of_all_leaves_no_gap():
    heard = HeardSamples()
    heard.begin(is_latched=False, repaired=frozenset({b"a"}))
    assert numbers(heard.new(samples(b"a", 1, 2))) == [1, 2]


def test_without_numbers_times_are_compared_and_without_ids_all_passes():
    heard = HeardSamples()
    unnumbered = [Sample(b"", 0, time_ns, None, b"a") for time_ns in (5, 5, 6)]
    assert heard.new(unnumbered) == unnumbered[1:]
    heard.begin(is_latched=False, repaired=frozenset({b"a"}))
    assert heard.new([Sample(b"", 0, 8, None, b"a")])
    anonymous = [Sample(b"", 0, 0, 1)] * 2
    assert heard.new(anonymous) == heard.retired(anonymous) == anonymous


def test_waiting_samples_are_bounded(monkeypatch):
    heard = HeardSamples()
    heard.begin(is_latched=True, repaired=frozenset())
    assert heard.retired(samples(b"a", 1, size=heard_samples.MAX_HELD_BYTES)) == []
    assert numbers(heard.retired(samples(b"b", 2))) == [1, 2]
    assert heard_samples.MAX_HELD_BYTES == 8 * 1024**2


def test_1024_publishers_are_known():
    heard = HeardSamples()
    for number in range(1024):
        heard.new(samples(b"%d" % number, 1))
    assert heard.new(samples(b"0", 1)) == []
    heard.new(samples(b"1024", 1))
    assert numbers(heard.new(samples(b"0", 1))) == [1]
