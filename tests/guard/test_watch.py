# SPDX-License-Identifier: Apache-2.0
from gateway.guard.watch import UNHEARD_NS, ZEROS, CommandWatch

MS = 1_000_000
SILENCE_NS = 575 * MS
T = "/cmd_vel"


def watch() -> CommandWatch:
    watch = CommandWatch(SILENCE_NS)
    watch.open(T)
    return watch


def moving() -> CommandWatch:
    guard = watch()
    guard.moving(T, 0)
    return guard


def zeros(watch: CommandWatch, now_ns: int, until_ns: int, heard_from_ns: int = 0) -> list[int]:
    """Return the times of the zeros that go out, at each due time."""
    sent = []
    while (due := watch.due_ns) is not None and due <= until_ns:
        now_ns = max(now_ns, due)
        times = watch.zeros(now_ns, lambda topic, now=now_ns: now >= heard_from_ns)
        sent += [now_ns] * len(times)
        if not times and not watch.silent(now_ns):
            break
    return sent


def test_a_silent_gateway_is_noticed_after_the_time_and_not_before():
    guard = moving()
    guard.moving(T, 100 * MS)
    assert guard.due_ns == 100 * MS + SILENCE_NS
    assert guard.silent(100 * MS + SILENCE_NS - 1) == []
    assert guard.silent(100 * MS + SILENCE_NS) == [T]
    assert zeros(guard, 675 * MS, 10_000 * MS) == [(675 + 50 * n) * MS for n in range(ZEROS)]
    assert not guard.is_stopping
    assert guard.due_ns is None


def test_a_gateway_that_has_stopped_the_robot_may_be_silent_and_may_end():
    guard = moving()
    guard.rest(T)
    assert guard.due_ns is None
    guard.lost(1)
    assert not guard.is_stopping


def test_the_guard_acts_at_once_for_a_gateway_that_is_gone():
    guard = moving()
    guard.lost(5 * MS)
    assert zeros(guard, 5 * MS, 10_000 * MS)[0] == 5 * MS


def test_the_end_of_the_pipe_begins_the_stop_only_once():
    guard = moving()
    guard.lost(0)
    assert guard.zeros(0, lambda topic: True) == [T]
    guard.lost(10 * MS)
    assert guard.zeros(10 * MS, lambda topic: True) == []


def test_a_gateway_that_moves_the_robot_again_ends_the_guards_stop():
    guard = moving()
    guard.silent(SILENCE_NS)
    guard.zeros(SILENCE_NS, lambda topic: True)
    guard.moving(T, SILENCE_NS + MS)
    assert not guard.is_stopping
    assert guard.zeros(SILENCE_NS + 60 * MS, lambda topic: True) == []


def test_zeros_that_no_robot_hears_do_not_count_for_a_while():
    guard = moving()
    guard.lost(0)
    sent = zeros(guard, 0, 20_000 * MS, heard_from_ns=1000 * MS)
    assert sent[-1] == 1200 * MS
    guard.moving(T, 0)
    guard.lost(0)
    sent = zeros(guard, 0, 20_000 * MS, heard_from_ns=10**18)
    assert sent[-1] == UNHEARD_NS + (ZEROS - 1) * 50 * MS <= 4200 * MS


def test_a_robot_that_misses_one_announcement_of_the_guard_hears_the_whole_stop():
    guard = moving()
    guard.lost(0)
    sent = zeros(guard, 0, 20_000 * MS, heard_from_ns=3000 * MS)  # when DDS repeats it
    assert sum(each >= 3000 * MS for each in sent) == ZEROS


def test_a_topic_that_is_not_open_is_not_watched():
    guard = CommandWatch(SILENCE_NS)
    guard.moving(T, 0)
    assert guard.due_ns is None
    guard.open(T)
    guard.moving(T, 0)
    guard.close(T)
    assert guard.due_ns is None
