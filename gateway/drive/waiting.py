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

from collections.abc import Hashable
from typing import Final, Literal

from gateway.drive.effects import Command, GuardState
from gateway.drive.table import StateTable
from gateway.drive.trip_latch import QUIET_NS

HOLD_NS: Final = QUIET_NS
GUARD_WAIT_NS: Final = 1_000_000_000  # a person who sent one command still looks at the robot

WaitingState = Literal["none", "alone", "guard"]
WaitingEvent = Literal[
    "single",
    "unready",
    "due",
    "due_unready",
    "late",
    "ready",
    "take_back",
    "refuse",
    "hand_over",
]
WaitingAction = Literal["", "hold", "replace", "extend", "send", "take_back", "refuse"]

_LATCH_FIRST: Final = "while a command is `alone`, the latch is `single`: no command passes it"
_NOTHING_DUE: Final = "nothing waits"
_NOT_ALONE: Final = "a command for the guard is refused as soon as it is due"

WAITING: Final[StateTable[WaitingState, WaitingEvent, WaitingAction]] = StateTable(
    "The command that waits",
    states={
        "none": "no command waits",
        "alone": "a single command waits for 250 ms, to see whether it is alone",
        "guard": "the newest command waits for the guard, for 1 s, of a joystick for one deadline",
    },
    events={
        "single": "a single command to move, by the latch",
        "unready": "a command to move passes the latch, and the guard is not ready",
        "due": "its time is over, and the guard is ready",
        "due_unready": "its time is over, and the guard is not ready",
        "late": "its 250 ms were over 250 ms ago: the gateway hung",
        "ready": "the guard becomes ready",
        "take_back": "a stop, or its client sends zero, an invalid message, or leaves",
        "refuse": "the next command is refused, control or the guard ends, or the gateway does",
        "hand_over": "another client gets control",
    },
    actions={
        "hold": "keep the command, and start its time",
        "replace": "keep the newer command, and the time",
        "extend": "keep the command until 1 s after it came",
        "send": "open the latch, accept the command, and publish it",
        "take_back": "forget the command",
        "refuse": "answer it with the reason of the event",
    },
    rows={
        "none": {
            "single": ("alone", "hold"),
            "unready": ("guard", "hold"),
            "ready": ("none", ""),
            "take_back": ("none", ""),
            "refuse": ("none", ""),
            "hand_over": ("none", ""),
        },
        "alone": {
            "single": ("alone", "replace"),
            "due": ("none", "send"),
            "due_unready": ("guard", "extend"),
            "late": ("none", "refuse"),
            "ready": ("alone", ""),
            "take_back": ("none", "take_back"),
            "refuse": ("none", "refuse"),
            "hand_over": ("none", "refuse"),
        },
        "guard": {
            "single": ("alone", "hold"),
            "unready": ("guard", "hold"),
            "due": ("none", "refuse"),
            "due_unready": ("none", "refuse"),
            "ready": ("none", "send"),
            "take_back": ("none", "take_back"),
            "refuse": ("none", "refuse"),
            "hand_over": ("none", "refuse"),
        },
    },
    impossible={
        ("alone", "unready"): _LATCH_FIRST,
        ("none", "due"): _NOTHING_DUE,
        ("none", "due_unready"): _NOTHING_DUE,
        ("none", "late"): _NOTHING_DUE,
        ("guard", "late"): _NOT_ALONE,
    },
)

_ROWS: Final = WAITING.rows


class WaitingCommand:
    """Its state, and the command with its times."""

    def __init__(self) -> None:
        self.state: WaitingState = "none"
        self.command: Command | None = None
        self.due_ns = 0  # in this state
        self._since_ns = 0  # when the command came

    @property
    def client(self) -> Hashable | None:
        """Return the client whose command waits."""
        return None if self.command is None else self.command.client

    def on(self, event: WaitingEvent) -> tuple[WaitingAction, Command | None]:
        """Go to the next state, and return the action and the command that waited."""
        self.state, action = _ROWS[self.state][event]
        command = self.command
        if self.state == "none":
            self.command = None
        elif action == "extend":
            self.due_ns = self._since_ns + GUARD_WAIT_NS
        return action, command

    def take_back(self, client: Hashable) -> bool:
        """Forget a client's command, and return whether there was one."""
        return self.client == client and self.on("take_back")[0] != ""

    def single(self, command: Command, now_ns: int) -> None:
        """Let a command wait for others to come after it."""
        action, _ = self.on("single")
        if action == "hold":
            self.due_ns = now_ns + HOLD_NS
        self.command, self._since_ns = command, now_ns

    def unready(self, command: Command, now_ns: int, deadline_ns: int) -> None:
        """Let a command wait for the guard: one of a joystick for at most one deadline.

        A joystick that has fallen silent moves no robot later.
        """
        is_joystick = self.command is not None and now_ns - self._since_ns < deadline_ns
        self.on("unready")
        wait_ns = min(deadline_ns, GUARD_WAIT_NS) if is_joystick else GUARD_WAIT_NS
        self.command, self._since_ns, self.due_ns = command, now_ns, now_ns + wait_ns

    def due_event(self, now_ns: int, guard: GuardState) -> WaitingEvent | None:
        """Return the event of its time, if its time is over."""
        if self.state == "none" or now_ns < self.due_ns:
            return None
        if self.state == "alone" and now_ns - self.due_ns >= HOLD_NS:
            return "late"
        return "due" if guard == "ready" else "due_unready"
