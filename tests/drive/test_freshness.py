# SPDX-License-Identifier: Apache-2.0
from gateway.drive.freshness import MAX_AGE_NS, Freshness

MS = 1_000_000
S = 1_000_000_000
CLOCKS_APART_NS = 77 * S


def at(sent_ms: float, late_ms: float = 0) -> tuple[float, int]:
    """Return a client's time, and the gateway's when it arrives so much later."""
    return sent_ms, CLOCKS_APART_NS + round((sent_ms + late_ms) * MS)


def test_a_command_without_a_time_has_no_known_age():
    assert Freshness().judge(None, 5 * S) == "unknown"


def test_a_command_250_ms_later_than_the_best_is_stale_and_a_little_less_is_not():
    freshness = Freshness()
    assert freshness.judge(*at(0)) == "unknown"
    assert freshness.judge(*at(700, late_ms=249)) == "unknown"  # of a young connection
    assert freshness.judge(*at(1800, late_ms=249)) == "fresh"
    assert freshness.judge(*at(2000, late_ms=251)) == "stale"
    assert freshness.judge(*at(2300, late_ms=20)) == "fresh"


def test_a_faster_command_makes_the_slower_ones_late():
    freshness = Freshness()
    freshness.judge(*at(0, late_ms=1000))
    assert freshness.judge(*at(2000, late_ms=1000)) == "fresh"
    assert freshness.judge(*at(3000)) == "fresh"
    assert freshness.judge(*at(3500, late_ms=1000)) == "stale"


def test_a_command_is_fresh_from_a_second_after_the_first():
    freshness = Freshness()
    freshness.judge(*at(0))
    assert freshness.judge(*at(999)) == "unknown"
    assert freshness.judge(*at(1000)) == "fresh"


def test_a_backlog_right_after_connecting_is_not_fresh():
    freshness = Freshness()
    ages = {freshness.judge(sent_ms, 9 * S) for sent_ms in range(0, 4000, 50)}
    assert "fresh" not in ages


def test_a_client_whose_clock_is_slow_stays_fresh_for_hours():
    freshness = Freshness()
    for minute in range(5 * 60):
        sent_ms = minute * 60_000 * (1 - 100e-6)
        age = freshness.judge(sent_ms, CLOCKS_APART_NS + minute * 60 * S)
        assert age == ("fresh" if minute else "unknown")


def test_a_command_without_a_time_is_as_old_as_what_may_have_waited():
    freshness = Freshness()
    assert freshness.judge(None, 5 * S, MAX_AGE_NS - 1) == "unknown"
    assert freshness.judge(None, 5 * S, MAX_AGE_NS) == "waited"
    assert freshness.judge(None, 5 * S, MAX_AGE_NS, is_behind=True) == "behind"
    assert freshness.judge(*at(0), MAX_AGE_NS) == "unknown"  # its own clock knows better
