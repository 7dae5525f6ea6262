# SPDX-License-Identifier: Apache-2.0
"""A pause of the writing to a client while its link has enough to do."""

import asyncio
import time
from collections.abc import Callable
from typing import Final

from gateway.transport.link import Link, Reading
from gateway.transport.tcp_info import read_tcp_info

# The link is looked at after so many bytes at the latest, 1 to 3 us each time: one that has become
# slow gets no more until that is noticed.
MAX_UNSEEN_BYTES: Final = 64 * 1024
# Waits until the next look at a full link. The first look comes at once, because uvloop writes at
# the end of a turn. Then the waits get longer.
SECOND_WAIT_S: Final = 0.001
MAX_WAIT_S: Final = 0.05


class Pacing:
    """Decides when a connection may write: while its socket accepts, and its link is not full.

    *on_resumed* is called when it may again, *on_rate* gets the rate of the link in bytes per
    second when it has changed, or ``None`` when the link is fast again.
    """

    def __init__(
        self,
        transport: asyncio.Transport,
        on_resumed: Callable[[], None],
        on_rate: Callable[[float | None], None],
    ) -> None:
        self._transport = transport
        self._socket = transport.get_extra_info("socket")
        self._on_resumed = on_resumed
        self._on_rate = on_rate
        self._link = Link()
        self._timer: asyncio.TimerHandle | None = None  # while the link is full
        self._wait_s = 0.0
        self._is_socket_full = False
        self.is_paused = False
        # before the next look at the link, 0 or less while it is paused
        self.room_bytes = self._link.window_bytes
        self.write: Callable[[bytes], object] = transport.write  # of a `PacedSocket`

    def read(self) -> Reading:
        """Return the reading of the kernel, or else of the transport."""
        waiting = self._transport.get_write_buffer_size()
        return read_tcp_info(self._socket) or Reading(-waiting, waiting, 0.0)

    def wrote(self, size: int) -> None:
        """Count bytes that were written, and look at the link when it is time."""
        self.room_bytes -= size
        if self.room_bytes < 0:
            self.look()

    def socket_full(self) -> None:
        """Pause until `socket_ready`."""
        self._is_socket_full = self.is_paused = True
        self.room_bytes = min(self.room_bytes, 0)

    def socket_ready(self) -> None:
        """Go on, unless the link is full."""
        self._is_socket_full = False
        self._resume()

    def look(self) -> None:
        """Look at the link, and pause if it is full."""
        reading = read_tcp_info(self._socket)
        if reading is None:
            self.room_bytes = self._most_room_bytes
            return
        link = self._link
        known = link.bytes_per_s
        link.read(reading, time.monotonic_ns())
        if link.bytes_per_s != known:
            self._on_rate(link.bytes_per_s)
        on_the_way = reading.on_the_way_bytes + self._transport.get_write_buffer_size()
        room = link.window_bytes - on_the_way
        self.room_bytes = min(room, self._most_room_bytes)
        if room < 0 and self._timer is None:
            self._wait(0.0 if link.bytes_per_s is None else -room / link.bytes_per_s)

    def close(self) -> None:
        """Look no more."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    @property
    def _most_room_bytes(self) -> int:
        """The most that may be written before the next look: nothing during a pause."""
        return 0 if self._is_socket_full or self._timer is not None else MAX_UNSEEN_BYTES

    def _wait(self, drained_s: float) -> None:
        self.is_paused = True
        wait_s = min(max(drained_s, self._wait_s), MAX_WAIT_S)
        self._wait_s = max(2 * self._wait_s, SECOND_WAIT_S)
        self._timer = asyncio.get_running_loop().call_later(wait_s, self._look_again)

    def _look_again(self) -> None:
        self._timer = None
        self.look()
        self._resume()

    def _resume(self) -> None:
        if self.is_paused and self._timer is None and not self._is_socket_full:
            self.is_paused = False
            self._wait_s = 0.0
            self._on_resumed()
