# SPDX-License-Identifier: Apache-2.0
"""The lease of a command topic: one client at a time drives."""

from collections.abc import Hashable
from dataclasses import dataclass

from gateway.drive.effects import Command, Rules


@dataclass(slots=True)
class Lease:
    """One client's right to command, until it is silent for a while.

    A client that takes it by a command need not know about leases, and many pages send zeros all
    day. So a lease that was taken by a command is weak while only zeros come: it does not keep
    another driver out. Zeros keep a lease that a client has asked for.
    """

    holder: Hashable
    renewed_ns: int
    driven_ns: int | None = None  # of the newest non-zero command
    is_asked_for: bool = False

    def is_over(self, now_ns: int, lease_ns: int) -> bool:
        """Return whether the holder has been silent for too long."""
        return now_ns - self.renewed_ns >= lease_ns

    def is_weak(self, now_ns: int, lease_ns: int) -> bool:
        """Return whether a client that drives may take it."""
        if self.is_asked_for:
            return False
        return self.driven_ns is None or now_ns - self.driven_ns >= lease_ns

    def admits(self, command: Command, now_ns: int, rules: Rules) -> bool:
        """Return whether a client may command, or take the lease by it."""
        if self.holder == command.client:
            return True
        # with "zero" a client that would drive has to stop first, and zeros take nothing away
        is_first = not command.velocity.is_zero and rules.first_command == "any"
        return is_first and self.is_weak(now_ns, rules.lease_ns)
