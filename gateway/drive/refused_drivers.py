# SPDX-License-Identifier: Apache-2.0
"""Clients that push while another one drives, until they let go."""

from collections.abc import Hashable

from gateway.drive.effects import Command


class RefusedDrivers:
    """The time at which each of them last pushed, for as long as it is connected.

    Its joystick does not move the robot when the other's lease ends, because that surprises people.
    A client has let go once it has commanded to stop, or has sent nothing for a deadline.
    """

    def __init__(self) -> None:
        self._pushed_ns: dict[Hashable, int] = {}

    def __len__(self) -> int:
        """Count them."""
        return len(self._pushed_ns)

    def refuse(self, command: Command, now_ns: int) -> None:
        """Note a command that was refused because another client drives."""
        if command.velocity.is_zero:
            self.forget(command.client)
        else:
            self._pushed_ns[command.client] = now_ns

    def still_pushes(self, command: Command, now_ns: int, deadline_ns: int) -> bool:
        """Take a command while no other client drives. Return whether its client must let go."""
        pushed_ns = self._pushed_ns.get(command.client)
        if pushed_ns is None:
            return False
        if command.velocity.is_zero or now_ns - pushed_ns >= deadline_ns:
            self.forget(command.client)
            return False
        self._pushed_ns[command.client] = now_ns
        return True

    def forget(self, client: Hashable) -> None:
        """Forget a client that has let go, has left, or has asked for control."""
        self._pushed_ns.pop(client, None)
