# SPDX-License-Identifier: Apache-2.0
"""The judgement of a client by time, by times of the test's own."""

import pytest

from gateway.config.limits import Limits
from gateway.core.outbox import Outbox
from gateway.transport.close_codes import SLOW_CONSUMER
from gateway.transport.end import EndCause
from gateway.transport.keep_alive import PING, Close, KeepAlive, Verdict
from gateway.transport.link import Reading

LIMITS = Limits(ping_interval_s=5, slow_consumer_s=5, send_queue_bytes=100_000)
DEAD_LINK = EndCause("network", "lost", "nothing acknowledged for 10 s")
TOOK_NOTHING = EndCause("gateway", "send_timeout", "it accepted nothing for 30 s")
HOUR_S = 3600


class Judged:
    """A client, its link, the data that waits for it, and the time."""

    def __init__(self) -> None:
        self.now_s = 1000.0
        self.keep_alive = KeepAlive(LIMITS, self.now_s)
        self.outbox = Outbox(LIMITS.send_queue_bytes)
        self.is_paused = False
        self.taken_bytes = self.waiting_bytes = 0
        self.unanswered_s = 0.0
        self.looks = 0

    def read(self) -> Reading:
        self.looks += 1
        return Reading(self.taken_bytes, self.waiting_bytes, 0.0, self.unanswered_s)

    def after(self, seconds: float, *, taken: int = 0) -> Verdict | None:
        self.now_s += seconds
        self.taken_bytes += taken
        return self.keep_alive.check(self.now_s, self.outbox, self)

    def during(self, seconds: int, *, taken: int = 0) -> list[Verdict]:
        """Let time pass in the server's ticks, in each of which some bytes are taken."""
        found = (self.after(0.25, taken=taken) for _ in range(4 * seconds))
        return [verdict for verdict in found if verdict is not None]


class Waiting:
    """An entry that waits in a queue."""

    is_being_encoded = False
    size = 40_000

    def frame(self) -> bytes:
        raise AssertionError("nothing is sent")


@pytest.fixture
def judged() -> Judged:
    return Judged()


@pytest.mark.parametrize("waiting_bytes", [0, 2])  # of a ping that is on its way whenever one looks
def test_a_client_that_answers_no_ping_stays_while_its_kernel_accepts_data(judged, waiting_bytes):
    judged.waiting_bytes = waiting_bytes
    assert judged.during(HOUR_S, taken=1) == [PING] * (HOUR_S // 5)
    assert judged.keep_alive.round_trip_s is None


def test_the_round_trip_is_from_the_oldest_unanswered_ping_to_the_next_answer(judged: Judged):
    judged.keep_alive.ponged(judged.now_s)
    assert judged.keep_alive.round_trip_s is None
    judged.during(12)
    for _ in range(2):  # it answers both
        judged.keep_alive.ponged(judged.now_s)
        assert judged.keep_alive.round_trip_s == 7
    judged.after(3)
    judged.keep_alive.ponged(judged.now_s + 0.5)
    assert judged.keep_alive.round_trip_s == 0.5


def test_no_ping_is_queued_behind_data_that_is_not_accepted(judged: Judged):
    judged.is_paused, judged.waiting_bytes = True, 100
    assert judged.during(20) == []


def test_a_client_that_accepts_nothing_is_cut_off_after_30_s_unless_it_accepts_a_byte(judged):
    judged.is_paused, judged.waiting_bytes = True, 100
    for _ in range(3):
        assert judged.during(30) == []
        assert judged.after(1, taken=1) is None
    assert judged.during(30) == []
    assert judged.after(1) == TOOK_NOTHING


def test_that_is_so_of_the_little_that_waits_while_the_socket_takes_more(judged: Judged):
    judged.waiting_bytes = 100
    assert next(verdict for verdict in judged.during(33) if verdict != PING) == TOOK_NOTHING


def test_a_client_that_has_accepted_all_has_the_full_time_again(judged: Judged):
    judged.is_paused, judged.waiting_bytes = True, 100
    assert judged.during(29) == []
    judged.waiting_bytes = 0
    assert judged.after(1) is None
    judged.waiting_bytes = 100
    assert judged.during(30) == []


def test_a_link_that_acknowledges_nothing_is_dead_after_10_s_however_often_it_has(judged: Judged):
    judged.unanswered_s = 10
    assert judged.after(1, taken=1) is None
    judged.unanswered_s = 10.1
    assert judged.after(1, taken=1) == DEAD_LINK


def test_the_kernel_is_asked_once_a_second(judged: Judged):
    judged.during(60)
    assert judged.looks == 60


def test_only_more_than_half_of_the_send_queue_is_a_backlog(judged: Judged):
    judged.is_paused = True
    queue = judged.outbox.open_queue(100, None)
    queue.put(Waiting())
    assert judged.after(5, taken=1) is None
    queue.put(Waiting())
    assert judged.after(5, taken=1) is None
    assert judged.after(5, taken=1) is None
    reason = "slow consumer: over half of 100000 bytes waiting for 5 s"
    assert judged.after(0.1, taken=1) == Close(SLOW_CONSUMER, reason)


def test_a_backlog_has_all_its_time_again_once_the_socket_takes(judged: Judged):
    judged.is_paused = True
    queue = judged.outbox.open_queue(100, None)
    for _ in range(2):
        queue.put(Waiting())
    assert judged.after(0) is None
    judged.is_paused = False
    assert judged.after(4) is None
    judged.is_paused = True
    assert judged.after(1) is None
    assert judged.after(5, taken=1) is None


def test_answers_alone_beyond_the_send_queue_end_it_at_once(judged: Judged):
    for _ in range(3):
        judged.outbox.put_control(bytes(60_000))
    reason = "slow consumer: answers alone exceed the send queue"
    assert judged.after(0) == Close(SLOW_CONSUMER, reason)
