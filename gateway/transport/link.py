# SPDX-License-Identifier: Apache-2.0
"""The rate at which a client's link drains, and its window: the bytes that may be on the way.

Data in the kernel or in a router can neither be dropped nor overtaken. So the gateway writes only
as much as the link drains within its round trip and a moment. The rate is measured while bytes are
on the way without a pause. A window that is too small corrects itself: it is drained in a round
trip without a queue, and that rate gives a larger one.
"""

from typing import Final, NamedTuple

# The queue before the slowest hop: enough to bridge the wait for a timer on a busy machine.
QUEUE_S: Final = 0.05
# Two full segments: less, and each would wait until the one before is acknowledged.
MIN_WINDOW_BYTES: Final = 3 * 1024
# Of a link that was never full: 32 messages, which one turn of the event loop takes from DDS.
FIRST_WINDOW_BYTES: Final = 64 * 1024
# A shorter sample would take a router's burst, or the acknowledgements that WiFi collects, for the
# rate of the link.
SAMPLE_NS: Final = 50_000_000
# No byte for so long is a hole in the radio, which says nothing about the rate.
STALL_NS: Final = 250_000_000
# Unless acknowledgements are always so rare: one segment takes half a second at 24 kbit/s.
STALL_GAPS: Final = 4
# A measured rate means little after some seconds. While the link is not full, the rate is assumed
# to grow by half each second, until the link is full again or fast enough.
GROWTH_PER_S: Final = 0.5
FAST_BYTES_PER_S: Final = 4e6

_NS_PER_S: Final = 1e9


class Reading(NamedTuple):
    """A connection at one moment, as the kernel knows it."""

    acked_bytes: int  # that the peer has acknowledged, of all that were sent
    on_the_way_bytes: int  # written, and not acknowledged yet
    min_rtt_s: float
    unanswered_s: float = 0.0  # since the last word of its kernel, while some is unacknowledged


class Link:
    """The rate of one connection, and its window."""

    __slots__ = (
        "_began",
        "_began_ns",
        "_gap_ns",
        "_has_paused",
        "_last",
        "_moved_ns",
        "_rate",
        "bytes_per_s",
        "window_bytes",
    )

    def __init__(self) -> None:
        self.window_bytes = FIRST_WINDOW_BYTES
        self.bytes_per_s: float | None = None  # of a link that was full, or None
        self._rate = FIRST_WINDOW_BYTES / QUEUE_S
        self._began: Reading | None = None  # of the sample
        self._began_ns = 0
        self._last = Reading(0, 0, 0.0)
        self._moved_ns = 0  # when something had been acknowledged last
        self._gap_ns = 0  # from the time before
        self._has_paused = True

    def read(self, reading: Reading, now_ns: int) -> None:
        """Learn from a reading. They may come at any times."""
        last, self._last = self._last, reading
        # otherwise some of those bytes are still on the way, and there was no pause
        self._has_paused |= reading.acked_bytes - last.acked_bytes >= last.on_the_way_bytes
        if reading.acked_bytes > last.acked_bytes:
            gap_ns = now_ns - self._moved_ns
            is_hole = gap_ns >= max(STALL_NS, STALL_GAPS * self._gap_ns)
            if is_hole and not self._has_paused:
                self._began = None
            self._moved_ns, self._gap_ns = now_ns, gap_ns
        if self._began is None:
            self._begin(reading, now_ns)
            return
        took_ns = now_ns - self._began_ns
        drained = reading.acked_bytes - self._began.acked_bytes
        if took_ns < SAMPLE_NS or not drained:
            return
        self._learn(drained * _NS_PER_S / took_ns, took_ns / _NS_PER_S)
        window_bytes = round(self._rate * (reading.min_rtt_s + QUEUE_S))
        self.window_bytes = max(MIN_WINDOW_BYTES, window_bytes)
        self._begin(reading, now_ns)

    def _begin(self, reading: Reading, now_ns: int) -> None:
        self._began, self._began_ns = reading, now_ns
        self._has_paused = False

    def _learn(self, rate: float, took_s: float) -> None:
        """Take a sample: of a full link its rate, of one that has paused a lower bound of it."""
        known = self._rate
        rate = min(rate, 2 * known)  # a router that passes on a burst does not show a rate
        if self._has_paused:
            grown = min(known * (1 + GROWTH_PER_S * took_s), FAST_BYTES_PER_S)
            self._rate = max(known, rate, grown)
        else:
            # a link that has become bad must be noticed at once, single samples are uneven
            self._rate = rate if rate < known / 2 else known + (rate - known) / 4
        if not self._has_paused:
            self.bytes_per_s = self._rate
        elif self.bytes_per_s is not None:
            self.bytes_per_s = None if self._rate >= FAST_BYTES_PER_S else self._rate
