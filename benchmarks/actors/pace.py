# SPDX-License-Identifier: Apache-2.0
"""The times at which samples are sent, and stamps that are unique."""

import heapq
import itertools
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Final

# Samples that may be sent at once. Receivers take samples that come together for less, so up to
# 10 kHz none do. Beyond, sleeps are not exact enough.
_BURST_S: Final = 0.0002
_UNIT_NS: Final = 1000  # a Twist carries microseconds


class Stamps:
    """Times of sending, strictly increasing and unique, even between *parts* processes."""

    def __init__(self, part: int = 0, parts: int = 1) -> None:
        self._offset_ns = part * _UNIT_NS
        self._step_ns = parts * _UNIT_NS
        self._last_ns = 0

    def next(self, now_ns: int) -> int:
        """Return the next stamp, *now_ns* to a few microseconds."""
        self._last_ns = max(now_ns // self._step_ns * self._step_ns, self._last_ns + self._step_ns)
        return self._last_ns + self._offset_ns


def paced(
    send: Callable[[], object],
    rate_hz: float,
    count: float,
    is_over: Callable[[], bool] = lambda: False,
) -> float:
    """Send *count* times, each when it is due, and return the seconds from first to last.

    Due times are absolute: a late sample delays none after it. Late samples are sent at twice the
    rate at most, so that a pause of this process does not flood the receiver.
    """
    burst = max(1, int(rate_hz * _BURST_S))
    started_s = begun_s = time.monotonic()
    sent = 0
    while sent < count and not is_over():
        due_s = max(started_s + sent / rate_hz, begun_s + burst / rate_hz / 2 if sent else 0.0)
        pause_s = due_s - time.monotonic()
        if pause_s > 0:
            time.sleep(pause_s)
        begun_s = time.monotonic()
        for _ in range(int(min(burst, count - sent))):
            send()
            sent += 1
    return time.monotonic() - started_s


def merged(rates_hz: Sequence[float]) -> Iterator[tuple[float, int]]:
    """Yield the due times of topics in their order, without end: seconds, and a topic's number.

    Topics of one rate are due one after the other, as those of independent nodes are.
    """
    return heapq.merge(
        *(_dues(rate_hz, number, len(rates_hz)) for number, rate_hz in enumerate(rates_hz))
    )


def _dues(rate_hz: float, number: int, numbers: int) -> Iterator[tuple[float, int]]:
    return (((turn + number / numbers) / rate_hz, number) for turn in itertools.count())
