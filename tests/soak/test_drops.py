# SPDX-License-Identifier: Apache-2.0
"""A sample that is missing and not counted is found."""

from tests.soak.drops import Drops


def drops(*frames: tuple[int, int]) -> Drops:
    found = Drops()
    for seq, dropped in frames:
        found.add(seq, dropped)
    return found


def test_a_counted_drop_is_not_a_fault():
    assert drops((10, 0), (11, 0), (15, 3)).as_json() == {
        "missing": 3,
        "counted": 3,
        "uncounted": 0,
    }


def test_a_drop_that_nobody_counted_is_found():
    assert drops((10, 0), (15, 3)).uncounted == 1


def test_a_drop_may_be_counted_before_it_is_seen():
    found = drops((10, 1), (13, 2))
    assert (found.missing, found.counted, found.uncounted) == (2, 2, 0)


def test_another_connection_starts_again_and_adds_up():
    found = drops((10, 0), (15, 4))
    found.connect()
    found.add(100, 0)
    found.add(102, 1)
    assert (found.missing, found.counted, found.uncounted) == (5, 5, 0)
