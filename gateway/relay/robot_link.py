# SPDX-License-Identifier: Apache-2.0
"""The way of commands and operations to a robot, as the command topics of a relay need it."""

from collections.abc import Callable
from typing import Protocol

from gateway.sources.zenoh.driving_wire import RemoteCommand, RemoteOperation, RemoteStop, Told

OnTold = Callable[[Told | None], None]


class RobotLink(Protocol):
    """The way to a robot. Nothing here waits."""

    relay: str  # the name of this relay

    def ask(self, operation: RemoteOperation | RemoteStop, on_told: OnTold) -> None:
        """Send an operation. *on_told* gets the answer, or None after a while without one."""

    def send(self, client: str, command: RemoteCommand) -> None:
        """Send a command."""

    def show(self, client: str) -> None:
        """Show the robot that a client is there, from now on or again."""

    def hide(self, client: str) -> None:
        """Show the robot that a client is gone."""

    def listen(self, *, is_on: bool) -> None:
        """Begin or end to get beats and states."""

    def close(self) -> None:
        """Hide all clients, and get nothing any more."""
