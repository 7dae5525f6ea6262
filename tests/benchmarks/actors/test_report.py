# SPDX-License-Identifier: Apache-2.0
"""A repeated message counts once, and the last tenth shows a backlog."""

from benchmarks.actors.report import Ages


def test_a_stamp_that_comes_twice_is_distinct_once():
    ages = Ages()
    for stamp_ns in (1000, 2000, 2000, 3000):
        ages.add(stamp_ns, stamp_ns + 5_000_000)
    assert ages.summary()["count"] == 4
    assert ages.summary()["distinct"] == 3


def test_a_backlog_at_the_end_shows_although_the_median_is_low():
    ages = Ages()
    for i in range(100):
        ages.add(i, i + (1_000_000 if i < 90 else 80_000_000))
    assert ages.summary()["p50_ms"] == 1
    assert ages.summary()["tail_ms"] == 80


def test_the_first_arrival_is_kept():
    ages = Ages()
    ages.add(100, 150)
    ages.add(200, 270)
    assert ages.summary()["first_ns"] == 150


def test_the_time_of_all_lasts_from_the_oldest_stamp_to_the_last_arrival():
    ages = Ages()
    ages.add(2_000_000, 4_000_000)
    ages.add(1_000_000, 9_000_000)
    assert ages.summary()["took_ms"] == 8


def test_nothing_is_left_after_clearing():
    ages = Ages()
    ages.add(1, 2)
    ages.clear()
    assert ages.summary() == {"count": 0, "distinct": 0}
