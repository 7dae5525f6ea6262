# SPDX-License-Identifier: Apache-2.0
import pytest

from gateway.transport.counters import ServerCounters
from gateway.transport.end import By, ConnectionEnd, EndCause, Reason


def end(by: By, reason: Reason, code: int | None = None) -> ConnectionEnd:
    return ConnectionEnd("10.0.0.1#1", EndCause(by, reason, "", code), 1.0, 0)


def test_the_largest_lag_is_that_of_the_last_forty_looks():
    counters = ServerCounters()
    assert counters.max_lag_s == 0
    counters.late(0.7)
    for _ in range(39):
        counters.late(0.01)
    assert counters.max_lag_s == 0.7
    counters.late(0.02)
    assert counters.max_lag_s == 0.02
    assert sum(counters.lag.observed().counts) == 41


@pytest.mark.parametrize(
    ("ended", "labels"),
    [
        (end("client", "closed", 1001), ("client", "closed", "1001")),
        (end("client", "closed", 4999), ("client", "closed", "other")),
        (end("gateway", "slow_consumer", 4503), ("gateway", "slow_consumer", "4503")),
        (end("network", "lost"), ("network", "lost", "")),
    ],
)
def test_ends_are_counted_by_whom_reason_and_code(
    ended: ConnectionEnd, labels: tuple[str, str, str]
):
    counters = ServerCounters()
    counters.ended(ended, was_client=True)
    assert counters.ends == {labels: 1}
    assert not counters.handshakes_refused


@pytest.mark.parametrize(
    ("ended", "reason"),
    [
        (end("gateway", "handshake", 403), "origin"),
        (end("gateway", "handshake", 431), "headers"),
        (end("gateway", "handshake", 426), "upgrade"),
        (end("gateway", "handshake", 500), "internal_error"),
        (end("gateway", "handshake", 503), "busy"),
        (end("gateway", "handshake"), "handshake"),
        (end("gateway", "going_away"), "going_away"),
        (end("gateway", "over_capacity", 1013), "over_capacity"),
        (end("client", "handshake"), "none"),
    ],
)
def test_a_refused_connection_is_counted_by_its_reason(ended: ConnectionEnd, reason: str):
    counters = ServerCounters()
    counters.ended(ended, was_client=False)
    assert counters.handshakes_refused == {reason: 1}


def test_a_page_is_not_a_refused_handshake():
    counters = ServerCounters()
    counters.ended(end("gateway", "http", 200), was_client=False)
    assert not counters.handshakes_refused
