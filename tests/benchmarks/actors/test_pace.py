# SPDX-License-Identifier: Apache-2.0
"""No two samples carry the same stamp, and exactly as many are sent as were asked for."""

import itertools

from benchmarks.actors.pace import Stamps, merged, paced

NOW_NS = 1_795_280_256_507_552_123


def test_stamps_increase_strictly_while_the_clock_stands_still():
    stamps = Stamps()
    seen = [stamps.next(NOW_NS) for _ in range(100)]
    assert all(later > earlier for earlier, later in itertools.pairwise(seen))


def test_stamps_of_two_senders_never_meet_and_follow_the_clock_in_whole_microseconds():
    senders = Stamps(0, 2), Stamps(1, 2)
    times = [NOW_NS + i * 700 for i in range(500)]
    seen = [stamps.next(time_ns) for stamps in senders for time_ns in times]
    assert len(set(seen)) == 1000
    assert all(stamp_ns % 1000 == 0 for stamp_ns in seen)
    assert all(abs(stamps.next(NOW_NS + 10**9) - NOW_NS - 10**9) <= 2000 for stamps in senders)


def test_exactly_as_many_are_sent_as_were_asked_for():
    for rate_hz, count in ((1e6, 2500), (3000.0, 7), (1e9, 1)):
        sent = []
        paced(lambda sent=sent: sent.append(1), rate_hz, count)
        assert len(sent) == count


def test_sending_ends_when_it_is_over():
    sent = []
    paced(lambda: sent.append(1), 1e6, 1e9, lambda: len(sent) >= 1000)
    assert 1000 <= len(sent) < 3000


def test_topics_are_due_in_order_each_at_its_own_rate_and_not_at_once():
    dues = list(itertools.takewhile(lambda due: due[0] < 2, merged([10.0, 100.0, 1.0])))
    assert dues == sorted(dues)
    assert [sum(number == one for _, one in dues) for number in range(3)] == [20, 200, 2]
    seconds = [due_s for due_s, _ in itertools.islice(merged([30.0] * 5), 100)]
    assert len(set(seconds)) == 100
