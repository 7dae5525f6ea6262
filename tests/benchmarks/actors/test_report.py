# SPDX-License-Identifier: Apache-2.0
"""A repeated message counts once, and the last tenth shows a backlog."""

from benchmarks.actors.report import Ages


def test_the_ages_of_messages_are_summed_up_and_a_stamp_that_comes_twice_is_distinct_once():
    ages = Ages()
    for stamp_ns, at_ns in ((2_000_000, 4_000_000), (1_000_000, 9_000_000), (2_000_000, 9_000_000)):
        ages.add(stamp_ns, at_ns)
    summary = ages.summary()
    assert (summary["count"], summary["distinct"]) == (3, 2)
    assert (summary["first_ns"], summary["took_ms"]) == (4_000_000, 8)  # since the oldest stamp
    ages.clear()
    assert ages.summary() == {"count": 0, "distinct": 0}


def test_a_backlog_at_the_end_shows_although_the_median_is_low():
    ages = Ages()
    for i in range(100):
        ages.add(i, i + (1_000_000 if i < 90 else 80_000_000))
    assert (ages.summary()["p50_ms"], ages.summary()["tail_ms"]) == (1, 80)
