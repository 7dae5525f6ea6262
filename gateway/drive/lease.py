# SPDX-License-Identifier: Apache-2.0
"""The lease of a command topic: one client at a time drives.

A client that takes it by a command need not know about leases, and many pages send zeros all day.
So a lease that was taken by a command is weak while only zeros come: it does not keep another
driver out. Zeros keep a lease that a client has asked for.
"""

from collections.abc import Hashable
from typing import Final, Literal

from gateway.drive.effects import Changed, Command, Effects, Rules
from gateway.drive.table import StateTable

LeaseState = Literal["free", "weak", "driven", "asked"]
LeaseEvent = Literal[
    "own_zero",
    "own_move",
    "other_zero",
    "other_move",
    "barred_move",
    "acquire",
    "other_acquire",
    "aged",
    "end",
]
LeaseAction = Literal["", "take", "renew", "drive", "refuse", "hand_over", "end"]

_NO_HOLDER: Final = "nobody has control"
_NOT_DRIVEN: Final = "only `driven` ages"

LEASE: Final[StateTable[LeaseState, LeaseEvent, LeaseAction]] = StateTable(
    "Lease",
    states={
        "free": "nobody has control",
        "weak": "a client has control by commands, and only zeros came for the time of a lease",
        "driven": "a client has control by commands to move",
        "asked": "a client has control because it asked for it",
    },
    events={
        "own_zero": "a zero command of the client with control",
        "own_move": "its command to move",
        "other_zero": "a zero command of another client",
        "other_move": "a command to move of another client, if any first command takes control",
        "barred_move": "the same, if the first command must be zero",
        "acquire": "the client with control asks for control, or any client if it is free",
        "other_acquire": "another client asks for control",
        "aged": "no command to move came for the time of a lease",
        "end": "release, disconnect, no permission, or silence for the time of a lease",
    },
    actions={
        "take": "the client gets control, watchers hear of it",
        "renew": "start the time of the lease again",
        "drive": "the same, and note the time of the command",
        "refuse": "refuse the command (`not_lease_holder`)",
        "hand_over": "take back what waits, then as `take`",
        "end": "nobody has control, watchers hear of it",
    },
    rows={
        "free": {
            "other_zero": ("weak", "take"),
            "other_move": ("driven", "take"),
            "barred_move": ("driven", "take"),
            "acquire": ("asked", "take"),
        },
        "weak": {
            "own_zero": ("weak", "renew"),
            "own_move": ("driven", "drive"),
            "other_zero": ("weak", "refuse"),
            "other_move": ("driven", "hand_over"),
            "barred_move": ("weak", "refuse"),
            "acquire": ("asked", "renew"),
            "other_acquire": ("asked", "hand_over"),
            "end": ("free", "end"),
        },
        "driven": {
            "own_zero": ("driven", "renew"),
            "own_move": ("driven", "drive"),
            "other_zero": ("driven", "refuse"),
            "other_move": ("driven", "refuse"),
            "barred_move": ("driven", "refuse"),
            "acquire": ("asked", "renew"),
            "other_acquire": ("asked", "hand_over"),
            "aged": ("weak", ""),
            "end": ("free", "end"),
        },
        "asked": {
            "own_zero": ("asked", "renew"),
            "own_move": ("asked", "renew"),
            "other_zero": ("asked", "refuse"),
            "other_move": ("asked", "refuse"),
            "barred_move": ("asked", "refuse"),
            "acquire": ("asked", "renew"),
            "other_acquire": ("asked", "hand_over"),
            "end": ("free", "end"),
        },
    },
    impossible={
        ("free", "own_zero"): _NO_HOLDER,
        ("free", "own_move"): _NO_HOLDER,
        ("free", "other_acquire"): _NO_HOLDER,
        ("free", "end"): _NO_HOLDER,
        ("free", "aged"): _NOT_DRIVEN,
        ("weak", "aged"): _NOT_DRIVEN,
        ("asked", "aged"): _NOT_DRIVEN,
    },
)

ZEROS: Final[frozenset[LeaseEvent]] = frozenset({"own_zero", "other_zero"})
TAKING: Final[frozenset[LeaseAction]] = frozenset({"take", "hand_over"})
_ROWS: Final = LEASE.rows


class Lease:
    """Its state, the client that has control, and the times of its commands."""

    def __init__(self) -> None:
        self.state: LeaseState = "free"
        self.holder: Hashable | None = None
        self.renewed_ns = 0
        self._driven_ns = 0  # when the newest command to move came

    def claim(self, command: Command, now_ns: int, rules: Rules) -> LeaseEvent:
        """Return the event that a command is. The lease is not over."""
        is_zero = command.velocity.is_zero
        if self.holder == command.client:
            return "own_zero" if is_zero else "own_move"
        if self.state == "driven" and now_ns - self._driven_ns >= rules.lease_ns:
            self.on("aged")
        if is_zero:
            return "other_zero"
        return "other_move" if rules.first_command == "any" else "barred_move"

    def admits(self, claim: LeaseEvent) -> bool:
        """Return whether a client may command, or take the lease by it."""
        return _ROWS[self.state][claim][1] != "refuse"

    def on(self, event: LeaseEvent, client: Hashable | None = None, now_ns: int = 0) -> LeaseAction:
        """Go to the next state, and return the action."""
        self.state, action = _ROWS[self.state][event]
        if action == "end":
            self.holder = None
        elif action:
            self.holder, self.renewed_ns = client, now_ns
            if action != "renew":
                self._driven_ns = now_ns
        return action

    def end(self) -> Effects:
        """Let nobody have control, and return what watchers hear of it."""
        self.on("end")
        return [Changed()]
