# SPDX-License-Identifier: Apache-2.0
from gateway.metrics.histogram import TIME_BOUNDS_S, Histogram


def test_times_are_counted_up_to_and_including_their_bound():
    histogram = Histogram()
    for time_s in (0.0, 0.0005, 0.0006, 1.0, 99.0):
        histogram.observe(time_s)
    observed = histogram.observed()
    assert observed.counts[:2] == (2, 1)
    assert observed.counts[TIME_BOUNDS_S.index(1.0)] == 1
    assert observed.counts[-1] == 1
    assert observed.sum_s == 0.0005 + 0.0006 + 100


def test_buckets_are_cumulative_and_end_with_infinity():
    histogram = Histogram()
    histogram.observe(0.003)
    histogram.observe(9)
    buckets = histogram.observed().buckets()
    assert buckets[0] == ("0.0005", 0)
    assert buckets[3] == ("0.005", 1)
    assert buckets[-1] == ("+Inf", 2)


def test_a_time_before_a_clock_was_set_back_counts_as_none():
    histogram = Histogram()
    histogram.observe(-5)
    assert (histogram.observed().counts[0], histogram.observed().sum_s) == (1, 0)
