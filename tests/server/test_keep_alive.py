# SPDX-License-Identifier: Apache-2.0
"""The judgement of a client by time, by times of the test's own."""

import pytest

from gateway.config.limits import Limits
from gateway.protocol.outbox import Outbox
from gateway.server.close_codes import HEARTBEAT_TIMEOUT, SLOW_CONSUMER
from gateway.server.keep_alive import PING, Abort, Close, KeepAlive, Sending, Verdict

LIMITS = Limits(
    ping_interval_s=5,
    ping_timeout_s=5,
    send_deadline_s=5,
    slow_consumer_s=5,
    send_queue_bytes=100_000,
)
NO_PONG = Close(HEARTBEAT_TIMEOUT, "no pong within 5 s")


class Judged:
    """A client, what waits for it, and the time."""

    def __init__(self) -> None:
        self.now_s = 1000.0
        self.keep_alive = KeepAlive(LIMITS, self.now_s)
        self.outbox = Outbox(LIMITS.send_queue_bytes)
        self.unsent_bytes = 0
        self.is_read = True
        self.is_paused = False

    def block(self, unsent_bytes: int) -> None:
        self.is_paused, self.unsent_bytes = True, unsent_bytes
        self.keep_alive.blocked(self.now_s)

    def after(self, seconds: float, *, taken: int = 0, heard: bool = False) -> Verdict | None:
        self.now_s += seconds
        self.unsent_bytes -= taken
        if heard:
            self.keep_alive.heard(self.now_s)
        sending = Sending(self.outbox, -self.unsent_bytes if self.is_paused else None)
        return self.keep_alive.check(self.now_s, sending, is_read=self.is_read)


class Waiting:
    """An entry that waits in a queue."""

    is_being_encoded = False
    size = 40_000

    def frame(self) -> bytes:
        raise AssertionError("nothing is sent")


@pytest.fixture
def judged() -> Judged:
    return Judged()


def test_who_is_silent_is_pinged_once_and_has_its_time_to_answer(judged: Judged):
    assert judged.after(5) is None
    assert judged.after(0.1) is PING
    assert judged.after(5) is None
    assert judged.after(0.1) == NO_PONG


def test_whatever_a_client_sends_is_an_answer(judged: Judged):
    assert judged.after(5.1) is PING
    assert judged.after(5, heard=True) is None
    assert judged.after(5) is None
    assert judged.after(0.1) is PING


def test_who_is_not_read_is_not_pinged_and_has_all_its_time_once_it_is(judged: Judged):
    assert judged.after(5.1) is PING
    judged.is_read = False
    for _ in range(3):
        assert judged.after(5.1) is None
    judged.is_read = True
    assert judged.after(5) is None
    assert judged.after(0.1) is PING


def test_who_takes_nothing_is_cut_off_and_who_takes_a_byte_is_not(judged: Judged):
    judged.block(100)
    for taken in (1, 1, 1):
        assert judged.after(5, taken=taken, heard=True) is None
    assert judged.after(5, heard=True) is None
    assert judged.after(0.1, heard=True) == Abort("took nothing for 5 s")


def test_a_full_socket_has_its_time_from_when_it_is_full(judged: Judged):
    judged.after(60, heard=True)
    judged.now_s += 60
    judged.block(100)
    assert judged.after(4, heard=True) is None


def test_a_ping_behind_bytes_that_are_being_taken_has_its_time_yet(judged: Judged):
    judged.block(100)
    assert judged.after(5, taken=1) is None
    assert judged.after(0.1, taken=1) is PING
    for _ in range(5):
        assert judged.after(5, taken=1) is None
    judged.is_paused = False
    assert judged.after(5.1) == NO_PONG


def test_half_of_the_send_queue_is_no_backlog_and_more_has_its_time(judged: Judged):
    judged.block(100)
    queue = judged.outbox.open_queue(100, None)
    queue.put(Waiting())
    assert judged.after(5, taken=1, heard=True) is None
    queue.put(Waiting())
    assert judged.after(5, taken=1, heard=True) is None
    assert judged.after(5, taken=1, heard=True) is None
    verdict = judged.after(0.1, taken=1, heard=True)
    reason = "slow consumer: over half of 100000 bytes waiting for 5 s"
    assert verdict == Close(SLOW_CONSUMER, reason)


def test_a_backlog_has_all_its_time_again_once_the_socket_takes(judged: Judged):
    judged.block(100)
    queue = judged.outbox.open_queue(100, None)
    for _ in range(2):
        queue.put(Waiting())
    assert judged.after(0, heard=True) is None
    judged.is_paused = False
    assert judged.after(5, heard=True) is None
    judged.block(100)
    assert judged.after(0, heard=True) is None
    assert judged.after(5, taken=1, heard=True) is None


def test_answers_alone_beyond_the_send_queue_end_it_at_once(judged: Judged):
    for _ in range(3):
        judged.outbox.put_control(bytes(60_000))
    reason = "slow consumer: answers alone exceed the send queue"
    assert judged.after(0) == Close(SLOW_CONSUMER, reason)
