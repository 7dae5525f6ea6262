# SPDX-License-Identifier: Apache-2.0
"""The highest rate that is held: everything arrives, and nothing is late at the end.

A run sends an exact number of samples, each with a separate stamp, and counts the stamps.
"""

import contextlib
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager
from typing import Final

from benchmarks.processes import Process, wait_until
from benchmarks.receivers import Receiver, Receiving, publishing
from benchmarks.samples import SAMPLES
from benchmarks.search import Highest, Outcome, highest_rate

_SENT_SHARE: Final = 0.98  # of the rate, by the sender
_DELIVERED_SHARE: Final = 0.999
_GRACE_S: Final = 1.0  # for the last samples
_BACKLOG_MS: Final = 50.0
_BACKLOG_LARGE_MS: Final = 200.0
_LARGE_BYTES: Final = 500_000
_SENDERS: Final = 2  # a call takes Python about 20 us
_CALM_S: Final = 0.4
_RUN_S: Final = 3.0
_MARGIN_S: Final = 30.0

Sending = Callable[[str], AbstractContextManager[Process]]
"""Starts one of several senders, given its share as ``PART/PARTS``."""


def highest_of(receiver: Receiver, sample: str, seconds: float) -> Highest:
    """Search the highest rate at which a receiver gets every sample."""
    with (
        senders(lambda share: publishing(sample, share=share)) as publishers,
        receiver.receiving(sample) as reception,
    ):
        wait_until(
            lambda: all(one.ask("matched") > 0 for one in publishers), "publishers are matched"
        )
        is_large = len(SAMPLES[sample].cdr()) > _LARGE_BYTES
        backlog_ms = _BACKLOG_LARGE_MS if is_large else _BACKLOG_MS
        return search(publishers, reception, SAMPLES[sample].rate_hz, seconds, backlog_ms)


@contextlib.contextmanager
def senders(sending: Sending) -> Iterator[list[Process]]:
    """Start as many as a search may need."""
    with contextlib.ExitStack() as stack:
        yield [stack.enter_context(sending(f"{part}/{_SENDERS}")) for part in range(_SENDERS)]


def search(
    sending: Sequence[Process],
    reception: Receiving,
    start_hz: float,
    seconds: float,
    backlog_ms: float = _BACKLOG_MS,
) -> Highest:
    """Search from *start_hz*, with one sender as long as that keeps the rate."""
    used = 1
    seconds = min(seconds, _RUN_S)

    def run(rate_hz: float) -> Outcome:
        return _run(sending[:used], reception, rate_hz, seconds, backlog_ms)

    def hold(rate_hz: float) -> Outcome:
        nonlocal used
        outcome = run(rate_hz)
        if outcome is Outcome.NOT_SENT and used < len(sending):
            used = len(sending)
        elif outcome is Outcome.HELD:
            return outcome
        return run(rate_hz)  # once more: a pause of the machine looks the same

    _run(sending[:used], reception, start_hz, 1.0, backlog_ms)  # warms up
    return highest_rate(hold, run, start_hz)


def _run(
    sending: Sequence[Process],
    reception: Receiving,
    rate_hz: float,
    seconds: float,
    backlog_ms: float,
) -> Outcome:
    _calm(reception)
    share_hz = rate_hz / len(sending)
    count = max(2, round(share_hz * seconds))
    for sender in sending:
        sender.send("run", share_hz, count)
    # a sender that is too slow takes longer
    runs = [sender.answer(_MARGIN_S + 30 * seconds) for sender in sending]
    total = count * len(sending)
    deadline_s = time.monotonic() + _GRACE_S
    while reception.count() < total and time.monotonic() < deadline_s:
        time.sleep(0.05)
    seen = reception.report()
    outcome = Outcome.HELD
    if any((count - 1) / run["seconds"] < _SENT_SHARE * share_hz for run in runs):
        outcome = Outcome.NOT_SENT
    elif seen["distinct"] < _DELIVERED_SHARE * total or seen["tail_ms"] > backlog_ms:
        outcome = Outcome.LOST
    print(
        f"  {reception.actor.name} at {rate_hz:.0f} Hz: {outcome.name.lower()} ("
        f"{seen['distinct']} of {total}, median of the last {seen.get('tail_ms', 0):.1f} ms)",
        file=sys.stderr,
    )
    return outcome


def _calm(reception: Receiving) -> None:
    """Wait until the rest of the last run has arrived, and forget it."""
    last = -1

    def is_calm() -> bool:
        nonlocal last
        before, last = last, reception.count()
        if last != before:
            time.sleep(_CALM_S)
        return last == before

    wait_until(is_calm, "nothing more comes of the last run")
    reception.clear()
