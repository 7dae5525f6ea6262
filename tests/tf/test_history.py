# SPDX-License-Identifier: Apache-2.0
"""One frame over time."""

from hypothesis import example, given
from hypothesis import strategies as st

from gateway.tf.history import HISTORY_NS, JUMP_BACK_NS, History
from gateway.tf.rigid import Rigid

SECOND = 1_000_000_000


def at(x):
    return Rigid(float(x), 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)


def test_between_two_samples_it_is_interpolated_and_outside_of_all_unknown():
    frame = History(10 * SECOND, "odom", at(1))
    frame.add(12 * SECOND, "odom", at(3))
    assert frame.at(10 * SECOND) == at(1)
    assert frame.at(11 * SECOND) == at(2)
    assert frame.at(12 * SECOND) == at(3)
    assert frame.at(10 * SECOND - 1) is None
    assert frame.at(12 * SECOND + 1) is None


def test_samples_may_come_out_of_order():
    frame = History(0, "odom", at(0))
    for second in (2, 1):
        assert frame.add(second * SECOND, "odom", at(second * second))
    assert frame.at(SECOND) == at(1)
    assert frame.at(3 * SECOND // 2) == at(2.5)


def test_of_two_samples_of_one_time_the_last_stays():
    frame = History(0, "odom", at(0))
    assert frame.add(0, "odom", at(1))
    assert not frame.add(0, "odom", at(1))
    assert frame.at(0) == at(1)


def test_between_two_parents_it_is_where_it_was_in_the_earlier():
    frame = History(0, "odom", at(0))
    frame.add(2 * SECOND, "map", at(5))
    assert frame.parent(SECOND) == "odom"
    assert frame.at(SECOND) == at(0)
    assert frame.parent(None) == frame.parent(2 * SECOND) == "map"
    assert frame.parents == {"odom", "map"}


@given(st.lists(st.tuples(st.integers(0, 15), st.sampled_from("abc")), min_size=1, max_size=20))
@example([(0, "a"), (2, "a"), (1, "b")])
@example([(0, "b"), (11, "b"), (9, "a")])
@example([(0, "a"), (0, "b"), (1, "b"), (0, "c"), (1, "a")])
def test_every_sample_keeps_its_parent_in_whatever_order_they_come(samples):
    second_ns = HISTORY_NS // 10  # so that some expire, and some begin a new history
    frame = None
    parents: dict[int, str] = {}  # by stamp
    for number, parent in samples:
        stamp_ns = number * second_ns
        if frame is None:
            frame = History(stamp_ns, parent, at(0))
        else:
            frame.add(stamp_ns, parent, at(0))
        if stamp_ns < max(parents, default=0) - JUMP_BACK_NS:
            parents = {}
        parents[stamp_ns] = parent
        newest = max(parents)
        parents = {s: parent for s, parent in parents.items() if s >= newest - HISTORY_NS}
        assert {s: frame.parent(s) for s in parents} == parents
        assert frame.parents == set(parents.values())
        assert frame.parent(None) == parents[newest]
        assert len(frame._starts) <= len(parents)


def test_samples_older_than_the_history_are_removed():
    frame = History(0, "odom", at(0))
    frame.add(5 * SECOND, "odom", at(1))
    frame.add(10 * SECOND, "odom", at(2))
    assert frame.oldest_ns == 0
    frame.add(10 * SECOND + 1, "odom", at(2))
    assert frame.oldest_ns == 5 * SECOND


def test_samples_are_bounded():
    frame = History(0, "odom", at(0))
    for stamp in range(1, 2010):
        frame.add(stamp, "odom", at(stamp))
    assert (frame.oldest_ns, frame.newest_ns) == (10, 2009)
    assert frame.at(11) == at(11)


def test_a_sample_from_long_before_begins_a_new_history():
    frame = History(100 * SECOND, "odom", at(0))
    frame.add(98 * SECOND, "odom", at(1))
    assert (frame.oldest_ns, frame.newest_ns) == (98 * SECOND, 100 * SECOND)
    frame.add(98 * SECOND - 1, "odom", at(2))
    assert (frame.oldest_ns, frame.newest_ns) == (98 * SECOND - 1, 98 * SECOND - 1)
