# SPDX-License-Identifier: Apache-2.0
"""A stop as both processes send it, the gateway and its guard: zeros, then silence."""

from typing import Final

from gateway.drive.effects import Changed, Effects, Send
from gateway.drive.velocity import ZERO

ZEROS: Final = 5  # one is enough for a reliable reader, but a best-effort one may lose some
ZERO_PERIOD_NS: Final = 50_000_000  # the last one after 200 ms
LIFESPAN_NS: Final = 250_000_000  # of every command, in DDS: an old one must not move anything


class Zeros:
    """The zeros of the gateway's stop that have yet to go out."""

    def __init__(self) -> None:
        self.left = 0
        self.next_ns = 0

    def begin(self, now_ns: int) -> Effects:
        """Send the first one. `tick` sends the others."""
        self.left, self.next_ns = ZEROS, now_ns
        return self.tick(now_ns)

    def end(self) -> None:
        """Send no more: a command to move goes out."""
        self.left = 0

    def tick(self, now_ns: int) -> Effects:
        """Send one if it is due."""
        if not self.left or now_ns < self.next_ns:
            return []
        self.left -= 1
        self.next_ns = now_ns + ZERO_PERIOD_NS
        return [Send(ZERO)] if self.left else [Send(ZERO), Changed()]
