# SPDX-License-Identifier: Apache-2.0
"""A command to move that must not go out yet.

It meets a guard that is not ready, or it is a single one.

A person who types commands by hand sends a single one and knows that the robot moves for one
deadline. Such a motion of one command ends with a latch that allows a single command. That command
waits for `HOLD_NS`. It goes out unless more arrive together, as in a backlog, because a segment of
TCP holds several. Commands that arrive one by one in this time replace it.

Without the client's clock, a single late command looks like a timely one. Clients that send their
time do not need this rule, and do not get it.
"""

from dataclasses import dataclass
from typing import Final

from gateway.drive.effects import Command
from gateway.drive.trip_latch import QUIET_NS

HOLD_NS: Final = QUIET_NS
GUARD_WAIT_NS: Final = 1_000_000_000  # a person who sent one command still looks at the robot


@dataclass(slots=True)
class Held:
    """It waits for the guard, or until a time, for others to come after it."""

    command: Command
    since_ns: int  # when it came
    until_ns: int | None
    wait_ns: int = GUARD_WAIT_NS

    @property
    def due_ns(self) -> int:
        """The time at which it goes out, or no longer does."""
        return self.until_ns or self.since_ns + self.wait_ns


def for_guard(command: Command, now_ns: int, before: Held | None, deadline_ns: int) -> Held:
    """Let a command wait for the guard: one of a joystick for at most one deadline.

    *before* waits until now. A joystick that has fallen silent moves no robot later.
    """
    is_stick = before is not None and now_ns - before.since_ns < deadline_ns
    return Held(
        command, now_ns, None, min(deadline_ns, GUARD_WAIT_NS) if is_stick else GUARD_WAIT_NS
    )
