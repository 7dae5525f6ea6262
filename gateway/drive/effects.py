# SPDX-License-Identifier: Apache-2.0
"""Inputs and outputs of a drive, as data."""

from collections.abc import Hashable
from dataclasses import dataclass, replace
from typing import Literal

from gateway.drive.freshness import Age
from gateway.drive.velocity import Velocity

Code = Literal["tripped", "not_lease_holder", "stale_command", "invalid_value"]

Cause = Literal[
    "zero",  # the client's own all-zero command
    "stop",  # the operation
    "release",
    "deadline",  # no command in time
    "disconnect",
    "takeover",
    "lease",  # it ended while the robot moved
    "permission",
    "invalid_value",
    "backlog",  # many commands at once, after silence
    "guard",
    "reader",  # another subscription was discovered, perhaps that of a robot that starts
    "shutdown",
    "start",  # not a stop: by configuration the first command must be zero
]


@dataclass(frozen=True, slots=True)
class Command:
    """One command of a client. *request* is handed back if it is refused later."""

    client: Hashable
    velocity: Velocity
    age: Age = "unknown"
    request: object = None

    def clamped(self, rules: "Rules") -> "Command":
        """Return it with speeds within the limits, itself if they are."""
        velocity = self.velocity.clamped(rules.max_linear, rules.max_angular)
        return self if velocity == self.velocity else replace(self, velocity=velocity)


@dataclass(frozen=True, slots=True)
class Send:
    """Publish a velocity now."""

    velocity: Velocity


@dataclass(frozen=True, slots=True)
class Refused:
    """Answer a command with an error."""

    command: Command
    code: Code
    reason: str


@dataclass(frozen=True, slots=True)
class Stopped:
    """Record that a stop has begun, while the robot moved or because a client asked for it."""

    cause: Cause
    client: Hashable | None  # that drove
    is_tripped: bool


@dataclass(frozen=True, slots=True)
class Clamped:
    """A command was faster than allowed. *velocity* is the reduced one."""

    command: Command
    velocity: Velocity


@dataclass(frozen=True, slots=True)
class Changed:
    """The status has changed."""


Effect = Send | Refused | Stopped | Clamped | Changed
Effects = list[Effect]
# It is prepared once it has discovered all listeners, and ready once they hear it.
GuardState = Literal["starting", "prepared", "ready", "lost"]
Motion = Literal["stopped", "moving", "stopping"]


@dataclass(frozen=True, slots=True)
class Status:
    """The state of a drive, for clients that ask."""

    motion: Motion
    holder: Hashable | None
    cause: Cause | None  # of the last stop
    is_tripped: bool
    guard: GuardState  # says ready once it is prepared: a client may begin then


@dataclass(frozen=True, slots=True)
class Rules:
    """The configured rules, see `gateway.config.control`."""

    deadline_ns: int
    lease_ns: int
    max_linear: float
    max_angular: float
    first_command: Literal["any", "zero"]
