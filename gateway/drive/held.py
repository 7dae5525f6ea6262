# SPDX-License-Identifier: Apache-2.0
"""A command to move that may not go out yet.

A person who types commands by hand sends a single one and knows that the robot moves for one
deadline. Such a motion, of one command, ends with a latch that allows a single command: it waits
for `HOLD_NS`, and goes out unless more come crowded, as those of a backlog do: a segment of TCP
holds several. Those that come one by one meanwhile replace it. A single late command cannot be told
from a timely one without the client's clock; clients that send their time have no use for this
rule, and do not get it.
"""

from dataclasses import dataclass

from gateway.drive.effects import Command


@dataclass(slots=True)
class Held:
    """It waits for the guard, or with a time, for others to come after it."""

    command: Command
    since_ns: int  # when it came
    until_ns: int | None
