# SPDX-License-Identifier: Apache-2.0
"""The limit on lines that clients cause, with a clock of the test."""

import logging
from typing import Any

import pytest

from gateway.log_rate import ALL_BURST, ALL_EVERY_S, BURST, EVERY_S, LogRate


class Log:
    """A rate, its clock, and the lines that pass."""

    def __init__(self) -> None:
        self.now_s = 1000.0
        self.rate = LogRate(lambda: self.now_s)
        self.written: list[logging.LogRecord] = []

    def write(self, message: str = "connected", *arguments: object, **extra: Any) -> bool:
        """Write as the handler does."""
        record = logging.LogRecord("gateway.x", logging.INFO, "", 0, message, arguments, None)
        record.__dict__.update(extra)
        if not self.rate.filter(record):
            return False
        self.written += [*self.rate.overdue(), record]
        return True

    def flood(self, count: int, **extra: Any) -> int:
        """Write so many. Return how many pass."""
        return sum(self.write(**extra) for _ in range(count))


@pytest.fixture
def log() -> Log:
    return Log()


def test_of_one_address_and_kind_a_few_pass_at_once_and_then_one_each_10_s(log: Log):
    assert log.flood(1000, client="10.0.0.5#1") == 32
    for _ in range(3):
        log.now_s += 9.8
        assert log.flood(1000, client="10.0.0.5#1") == 0
        log.now_s += 0.3
        assert log.flood(1000, client="10.0.0.5#1") == 1


def test_of_one_kind_a_hundred_pass_at_once_and_then_one_each_second(log: Log):
    def flood() -> int:
        return sum(log.write(client=f"10.{log.now_s}.{number}#1") for number in range(300))

    assert flood() == 128
    for _ in range(3):
        log.now_s += 0.95
        assert flood() == 0
        log.now_s += 0.06
        assert flood() == 1


def test_a_long_silence_saves_up_no_more_than_a_few(log: Log):
    log.flood(1, client="10.0.0.5#1")
    log.now_s += 1000 * EVERY_S
    assert log.flood(1000, client="10.0.0.5#1") == BURST


def test_the_next_line_that_passes_says_how_many_did_not(log: Log):
    log.flood(BURST + 1234, client="10.0.0.5#1")
    assert {each.left_out for each in log.written} == {None}
    log.now_s += EVERY_S
    log.write(client="10.0.0.5#2")
    assert log.written[-1].left_out == 1234
    log.now_s += EVERY_S
    log.write(client="10.0.0.5#3")
    assert log.written[-1].left_out is None


def test_connections_of_one_address_share_and_addresses_do_not(log: Log):
    assert sum(log.write(client=f"10.0.0.5#{number}") for number in range(1000)) == BURST
    assert log.write(client="10.0.0.6#1001")


def test_kinds_and_reasons_do_not_share(log: Log):
    log.flood(1000, client="10.0.0.5#1")
    assert log.write("refused %s", "x", client="10.0.0.5#1")
    assert log.flood(1000, client="10.0.0.5#1", reason="handshake") == BURST
    assert log.write(client="10.0.0.5#1", reason="slow_consumer")


def test_lines_that_differ_only_in_arguments_are_one_kind(log: Log):
    passed = [log.write("refused %s", number, client="10.0.0.5#1") for number in range(100)]
    assert sum(passed) == BURST


def test_a_topic_is_a_source_too(log: Log):
    assert log.flood(1000, topic="/image") == BURST
    assert log.write(topic="/odom")


def test_lines_that_no_client_causes_all_pass(log: Log):
    assert log.flood(1000) == 1000
    assert log.flood(1000, client="10.0.0.5#1", is_bounded=True) == 1000


def test_addresses_without_end_have_a_bound_together(log: Log):
    assert sum(log.write(client=f"10.0.{n // 250}.{n % 250}#1") for n in range(5000)) == ALL_BURST
    log.now_s += 10
    assert sum(log.write(client=f"10.1.{n // 250}.{n % 250}#1") for n in range(5000)) == 9
    assert len(log.written) == ALL_BURST + 10  # one is the number of those left out
    assert log.write("other kind", client="10.0.0.5#1")


def test_one_address_cannot_use_up_the_limit_of_all(log: Log):
    log.flood(100_000, client="10.0.0.5#1")
    for _ in range(60):
        log.now_s += 1
        log.flood(1000, client="10.0.0.5#1")
        assert log.write(client=f"10.0.1.{log.now_s:.0f}#1")


def test_addresses_without_end_take_a_bounded_memory_and_are_forgotten(log: Log):
    for number in range(3 * 1024):
        log.write(client=f"10.{number}#1")
    assert len(log.rate._buckets) == 1024
    log.now_s += EVERY_S * BURST
    log.write()
    assert len(log.rate._buckets) == 0
    assert len(log.rate._kinds) == 1


def test_an_address_in_debt_is_not_forgotten(log: Log):
    log.flood(1000, client="10.0.0.5#1")
    log.now_s += EVERY_S
    log.flood(1, client="10.0.0.5#1")
    assert log.flood(1000, client="10.0.0.5#1") == 0


def test_the_lines_left_out_of_an_address_are_reported_before_it_is_forgotten(log: Log):
    log.flood(BURST + 100, client="10.0.0.5#1")
    log.now_s += EVERY_S * BURST
    log.write()
    assert log.written[-2].left_out == 99
    log.now_s += EVERY_S
    log.write()
    assert len(log.rate._buckets) == 0
    assert log.written[-2].getMessage() == "connected"


def test_a_line_does_not_say_how_many_of_other_addresses_were_left_out(log: Log):
    for number in range(ALL_BURST + 1000):
        log.write(client=f"10.0.{number}#1")
    log.now_s += ALL_EVERY_S
    assert log.write(client="10.0.0.5#7")
    assert log.written[-1].left_out is None


def test_the_number_of_all_addresses_is_written_without_a_client_while_they_go_on(log: Log):
    for number in range(ALL_BURST + 1000):
        log.write(client=f"10.0.{number}#1", topic="/odom", reason="handshake")
    for second in range(10):
        log.now_s += ALL_EVERY_S + 0.01
        log.write(client=f"10.1.{second}#1", reason="handshake")
        log.write(client=f"10.2.{second}#1", reason="handshake")
    (late,) = [each for each in log.written if getattr(each, "left_out", None)]
    assert (late.getMessage(), late.reason, late.left_out) == ("connected", "handshake", 1008)
    assert not {"client", "topic"} & set(late.__dict__)
    assert list(log.rate.overdue()) == []  # it was said for these ten seconds


def test_after_a_flood_the_next_line_of_anybody_brings_the_number(log: Log):
    log.flood(BURST + 100, message="refused", client="10.0.0.5#7", reason="handshake")
    log.now_s += EVERY_S + 0.1
    log.write("shutting down")
    late = log.written[-2]
    assert (late.getMessage(), late.left_out) == ("refused", 99)
    assert (late.client, late.reason, late.levelname) == ("10.0.0.5#7", "handshake", "INFO")
    assert log.written[-1].getMessage() == "shutting down"
    log.now_s += 10 * EVERY_S
    log.write("again")
    assert log.written[-2].getMessage() == "shutting down"


def test_at_the_end_the_numbers_are_written_at_once(log: Log):
    log.flood(BURST + 100, client="10.0.0.5#7")
    assert list(log.rate.overdue()) == []
    (late,) = log.rate.overdue(all_of_them=True)
    assert late.left_out == 99
    assert list(log.rate.overdue(all_of_them=True)) == []


def test_a_kept_line_is_short_and_has_no_traceback(log: Log):
    for _ in range(BURST):
        log.write("%s", "x", client="10.0.0.5#1")
    log.write("%s", "x" * 10_000, client="10.0.0.5#1", exc_info=(None, None, None))
    (late,) = log.rate.overdue(all_of_them=True)
    assert len(late.getMessage()) == 500
    assert late.exc_info is None
