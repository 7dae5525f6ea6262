# SPDX-License-Identifier: Apache-2.0
"""A command to move that may not go out yet."""

from dataclasses import dataclass

from gateway.drive.effects import Command


@dataclass(slots=True)
class Held:
    """It waits for the guard, or with a time, for others to come after it."""

    command: Command
    since_ns: int  # when it came
    until_ns: int | None
