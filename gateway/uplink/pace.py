# SPDX-License-Identifier: Apache-2.0
"""The pace of an uplink: marks go to the router and back, and show how fast the link drains.

Zenoh says nothing about what waits in its queues, in the kernel or in a modem. Data there can
neither be dropped nor overtaken: a driver's commands would answer to old images.
"""

import asyncio
from collections import deque
from collections.abc import Callable
from typing import Final, NamedTuple

from gateway.transport.link import FAST_BYTES_PER_S, FIRST_WINDOW_BYTES, MIN_WINDOW_BYTES, QUEUE_S

# While a mark is under way, the next one follows after so many bytes: it has about 100 itself.
MARK_BYTES: Final = 4096
# Less would show the time that a mark takes by itself.
SAMPLE_BYTES: Final = 4096
MIN_SAMPLE_S: Final = 0.001
MIN_RTT_GROWTH: Final = 1.001  # with each mark: by half in some minutes
# Without anything to send, a mark shows that the link is there.
IDLE_S: Final = 1.0
# No mark has come back for so long: the router is gone, or passes nothing on. Zenoh notices that a
# router hangs after 10 s.
LOST_S: Final = 5.0


class MarkedLink:
    """The rate of a link, by the times that marks behind a number of bytes take.

    `gateway.transport.link.Link` needs what the kernel knows: here an image and its mark come back
    in one piece.
    """

    def __init__(self) -> None:
        self.window_bytes = FIRST_WINDOW_BYTES
        self.bytes_per_s: float | None = None  # of a link that is not fast
        self._rate = FIRST_WINDOW_BYTES / QUEUE_S
        self._min_rtt_s = float("inf")
        self._returned_s = 0.0  # when the newest mark came back

    def read(self, size: int, sent_s: float, now_s: float) -> None:
        """Take a mark that was sent behind *size* bytes at a time, and has come back now."""
        # another way may be longer
        self._min_rtt_s = min(now_s - sent_s, self._min_rtt_s * MIN_RTT_GROWTH)
        began_s = max(self._returned_s, sent_s + self._min_rtt_s)
        self._returned_s = now_s
        if size < SAMPLE_BYTES:
            return
        rate = size / max(now_s - began_s, MIN_SAMPLE_S)
        known = self._rate
        # a link that has become bad must be noticed at once, single samples are uneven
        self._rate = rate if rate < known / 2 else known + (min(rate, 2 * known) - known) / 4
        self.bytes_per_s = None if self._rate >= FAST_BYTES_PER_S else self._rate
        window_bytes = round(self._rate * (self._min_rtt_s + QUEUE_S))
        self.window_bytes = max(MIN_WINDOW_BYTES, window_bytes)


class _Mark(NamedTuple):
    number: int
    sent_bytes: int  # until then
    sent_s: float


class UplinkPace:
    """Counts what is on the way. *send_mark* sends a number, which comes back to `returned`.

    *on_room* is called when more may be sent. *on_rate* gets the rate of a link that is full, or
    ``None``. *on_lost* is called once if nothing comes back.
    """

    def __init__(
        self,
        send_mark: Callable[[int], None],
        *,
        on_room: Callable[[], None],
        on_rate: Callable[[float | None], None],
        on_lost: Callable[[], None],
    ) -> None:
        self._loop = asyncio.get_running_loop()
        self._send_mark = send_mark
        self._on_room, self._on_rate, self._on_lost = on_room, on_rate, on_lost
        self._link = MarkedLink()
        self._marks: deque[_Mark] = deque()
        self._number = 0
        self._sent = self._marked = self._acked = 0  # bytes
        self._heard_s = self._loop.time()
        self.proved = asyncio.Event()  # something has come back
        self._timer = self._loop.call_soon(self._tick)

    @property
    def room_bytes(self) -> int:
        """The bytes that may be sent now. None or fewer while the link is full."""
        return self._link.window_bytes - (self._sent - self._acked)

    def sent(self, size: int) -> None:
        """Count bytes that were sent."""
        self._sent += size

    def mark(self) -> None:
        """Send a mark behind what was sent, if it is time for one."""
        unmarked = self._sent - self._marked
        if unmarked and (not self._marks or unmarked >= MARK_BYTES):
            self._mark()

    def returned(self, number: int) -> None:
        """Take a mark that has come back, and with it all that was sent before."""
        known = None
        while self._marks and self._marks[0].number <= number:
            known = self._marks.popleft()
        if known is None:
            return
        now_s = self._loop.time()
        self._heard_s = now_s
        self.proved.set()
        before = self._link.bytes_per_s
        self._link.read(known.sent_bytes - self._acked, known.sent_s, now_s)
        self._acked = known.sent_bytes
        if self._link.bytes_per_s != before:
            self._on_rate(self._link.bytes_per_s)
        self.mark()
        self._on_room()

    def close(self) -> None:
        """Send no more marks."""
        self._timer.cancel()

    def _mark(self) -> None:
        self._number += 1
        self._marked = self._sent
        self._marks.append(_Mark(self._number, self._sent, self._loop.time()))
        self._send_mark(self._number)

    def _tick(self) -> None:
        now_s = self._loop.time()
        if now_s - self._heard_s >= LOST_S:
            self._on_lost()
            return
        # also if one is under way: of a full link, Zenoh drops marks as well
        self._mark()
        self._timer = self._loop.call_later(IDLE_S, self._tick)
