# SPDX-License-Identifier: Apache-2.0
"""The trip latch: after a stop that the driver did not ask for, it keeps the robot stopped.

When a network is back, it delivers within milliseconds everything that was sent while it was dead:
commands to move, and among them commands to stop. The operator has let go long ago. So a command to
stop resets the latch only when `QUIET_NS` have passed after it without a command to move. In a
backlog the next one comes within milliseconds. An operator takes longer to let go and push again. A
command that its client's clock proves fresh resets it at once.
"""

from typing import Final

from gateway.drive.effects import Cause, Changed, Effects
from gateway.drive.freshness import Age

QUIET_NS: Final = 250_000_000


class TripLatch:
    """Tripped or not, and the reset that may be under way."""

    def __init__(self) -> None:
        self.cause: Cause | None = None
        self.allows_single = False  # see `gateway.drive.drive`
        self._zero_ns: int | None = None

    @property
    def is_set(self) -> bool:
        """Return whether commands to move are refused."""
        return self.cause is not None

    @property
    def is_resetting(self) -> bool:
        """Return whether a command to stop has begun the reset."""
        return self._zero_ns is not None

    @property
    def due_ns(self) -> int | None:
        """The time at which the reset is over, if one is under way."""
        return None if self._zero_ns is None else self._zero_ns + QUIET_NS

    def trip(self, cause: Cause, *, allows_single: bool = False) -> None:
        """Refuse commands to move from now on."""
        self.cause = cause
        self.allows_single = allows_single
        self._zero_ns = None

    def zero(self, age: Age, now_ns: int) -> None:
        """Take a command to stop."""
        if age == "fresh":
            self._clear()
        elif self.is_set and age != "stale" and self._zero_ns is None:
            self._zero_ns = now_ns

    def spoil(self) -> Effects:
        """Take a command to move: the reset must begin again. Return what watchers see of it."""
        self._zero_ns = None
        had_single, self.allows_single = self.allows_single, False
        return [Changed()] if had_single else []

    def tick(self, now_ns: int) -> bool:
        """Return whether the reset is over now."""
        due_ns = self.due_ns
        if due_ns is None or now_ns < due_ns:
            return False
        if now_ns - due_ns >= QUIET_NS:
            # So late only if the gateway stood still: commands may wait that came in this time.
            self._zero_ns = now_ns
            return False
        self._clear()
        return True

    def _clear(self) -> None:
        self.cause = None
        self.allows_single = False
        self._zero_ns = None
