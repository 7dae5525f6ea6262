# SPDX-License-Identifier: Apache-2.0
from hypothesis import given
from hypothesis import strategies as st

from gateway.core.topics.throttle import Pace, Throttle
from tests.core.entries import Item

MS = 1_000_000


def run(
    throttle: Throttle, times_ms: list[float], *, late_ms: float = 0
) -> list[tuple[float, int]]:
    """Offer entry n at the n-th time. Return when which entry passed.

    The timer that releases an entry fires *late_ms* after the end of the interval.
    """
    passed: list[tuple[float, int]] = []
    timer_ns: int | None = None
    for number, time_ms in enumerate([*times_ms, 1e9]):
        now_ns = round(time_ms * MS)
        while timer_ns is not None and timer_ns <= now_ns:
            held = throttle.release(timer_ns)
            assert isinstance(held, Item)
            passed.append((timer_ns / MS, held.number))
            timer_ns = throttle.due_ns + round(late_ms * MS) if throttle else None
        if number == len(times_ms):
            break
        if throttle.passes(now_ns):
            passed.append((now_ns / MS, number))
            continue
        throttle.hold(Item(number))
        if timer_ns is None:
            timer_ns = throttle.due_ns + round(late_ms * MS)
    return passed


def test_the_first_passes_at_once_then_the_newest_of_each_interval_and_the_last():
    passed = run(Throttle(Pace(100 * MS)), [1000, 1010, 1050, 1090, 1120, 1130])
    assert passed == [(1000, 0), (1100, 3), (1200, 5)]


def test_an_entry_after_a_pause_passes_at_once_and_begins_a_new_beat():
    assert run(Throttle(Pace(100 * MS)), [1000, 5030, 5040]) == [(1000, 0), (5030, 1), (5130, 2)]


def test_late_timers_do_not_slow_the_beat_down():
    passed = run(
        Throttle(Pace(100 * MS)), [10 * number for number in range(1000, 1100)], late_ms=20
    )
    assert [time_ms for time_ms, _ in passed] == [10_000, *range(10_120, 11_100, 100)]


@given(
    st.lists(st.integers(1, 300), min_size=1, max_size=40),
    st.integers(1, 200),
)
def test_entries_keep_their_distance_and_the_last_one_arrives(gaps_ms, interval_ms):
    times, now = [], 10_000.0
    for gap in gaps_ms:
        now += gap
        times.append(now)
    passed = run(Throttle(Pace(interval_ms * MS)), times)
    assert passed[-1][1] == len(times) - 1
    assert passed[0][1] == 0
    numbers = [number for _, number in passed]
    assert numbers == sorted(set(numbers))
    # on average never faster than asked for: a late entry does not slow the beat down
    assert (len(passed) - 2) * interval_ms <= passed[-1][0] - passed[0][0]


def test_a_throttle_with_a_queue_lets_all_pass_one_per_interval():
    passed = run(Throttle(Pace(200 * MS, 10)), [1000, 1001, 1002, 1003, 1004, 1005])
    assert passed == [(1000 + 200 * number, number) for number in range(6)]


def test_of_more_than_the_queue_holds_the_oldest_make_room():
    passed = run(Throttle(Pace(100 * MS, 2)), [1000, 1001, 1002, 1003, 1004])
    assert passed == [(1000, 0), (1100, 3), (1200, 4)]
    throttle = Throttle(Pace(100 * MS, 2))
    assert throttle.passes(0)
    assert [throttle.hold(Item(number)) for number in range(4)] == [0, 0, 1, 1]
    assert len(throttle) == 2


def test_of_more_than_8_mib_the_oldest_make_room_but_one_is_held():
    throttle = Throttle(Pace(100 * MS, 1000))
    assert throttle.passes(0)
    mib = 1024**2
    assert [throttle.hold(Item(0, size=3 * mib)) for _ in range(4)] == [0, 0, 1, 1]
    assert throttle.hold(Item(0, size=9 * mib)) == 2
    assert len(throttle) == 1


def test_entries_make_room_for_those_of_the_same_publisher():
    throttle = Throttle(Pace(100 * MS))
    assert throttle.passes(0)
    whose = [b"a", b"b", b"a", b"c", b"b"]
    assert [throttle.hold(Item(at), each) for at, each in enumerate(whose)] == [0, 0, 1, 0, 1]
    assert [throttle.release(at * 100 * MS) for at in (1, 2, 3)] == [Item(2), Item(4), Item(3)]
    dropped = [throttle.hold(Item(number), b"%d" % number) for number in range(257)]
    assert dropped == [0] * 256 + [1]


def test_no_publisher_waits_forever_behind_slower_ones():
    throttle = Throttle(Pace(100 * MS, 2))
    assert throttle.passes(0)
    passed = []
    for at in range(1, 40):
        throttle.hold(Item(at), b"slow")
        for number in range(5):
            throttle.hold(Item(100 * at + number), b"fast")
        held = throttle.release(at * 100 * MS)
        assert isinstance(held, Item)
        passed.append(held.number)
    fast, slow = ([one for one in passed if (one >= 100) is is_fast] for is_fast in (True, False))
    assert abs(len(fast) - len(slow)) <= 2
    assert (fast, slow) == (sorted(fast), sorted(slow))


def test_entries_that_were_forgotten_are_not_released():
    throttle = Throttle(Pace(100 * MS, 2))
    assert throttle.passes(0)
    throttle.hold(Item(2))
    throttle.clear()
    assert len(throttle) == 0
    assert throttle.release(100 * MS) is None
