# SPDX-License-Identifier: Apache-2.0
"""The motion of a robot by commands: what has been accepted, and what has gone out."""

from typing import Final, Literal

from gateway.drive.effects import Changed, Command, Effects
from gateway.drive.table import StateTable

MotionState = Literal["standing", "passing", "starting", "burst", "moving", "steering"]
MotionEvent = Literal["move", "zero", "send", "wait", "end", "halt", "hand_over"]
MotionAction = Literal["", "begin", "replace", "keep", "drop", "pass", "drive", "stop"]
MOVING: Final[frozenset[MotionState]] = frozenset({"starting", "burst", "moving", "steering"})
STARTS: Final[frozenset[MotionState]] = frozenset({"starting", "burst"})

_STOPPED_FIRST: Final = "another client's motion is stopped before it loses control"
_AFTER_THE_FIRST: Final = "only the first command of a motion waits for time"

MOTION: Final[StateTable[MotionState, MotionEvent, MotionAction]] = StateTable(
    "Motion",
    states={
        "standing": "no command is on its way",
        "passing": "a zero command goes out at the end of this turn",
        "starting": "the first command to move goes out at the end of this turn",
        "burst": "the first command waits until time explains those that came with it",
        "moving": "the newest command has gone out",
        "steering": "a newer command goes out at the end of this turn",
    },
    events={
        "move": "a command to move is accepted",
        "zero": "a zero command of the client with control",
        "send": "the turn ends, or the burst is explained",
        "wait": "the turn ends before the burst is explained",
        "end": "a reason to stop a robot that moves",
        "halt": "a reason to stop in any case",
        "hand_over": "another client gets control",
    },
    actions={
        "begin": "start the deadline, count commands from 1, watchers hear of it",
        "replace": "start the deadline again, forget the older command",
        "keep": "keep the zero command, and show it to the latch",
        "drop": "forget the zero command",
        "pass": "publish the zero command",
        "drive": "publish the command, end the zeros of an earlier stop",
        "stop": "forget all commands, trip the latch by the cause, send five zeros",
    },
    rows={
        "standing": {
            "move": ("starting", "begin"),
            "zero": ("passing", "keep"),
            "send": ("standing", ""),
            "end": ("standing", ""),
            "halt": ("standing", "stop"),
            "hand_over": ("standing", ""),
        },
        "passing": {
            "move": ("starting", "begin"),
            "zero": ("passing", "keep"),
            "send": ("standing", "pass"),
            "end": ("passing", ""),
            "halt": ("standing", "stop"),
            "hand_over": ("standing", "drop"),
        },
        "starting": {
            "move": ("starting", "replace"),
            "zero": ("standing", "stop"),
            "send": ("moving", "drive"),
            "wait": ("burst", ""),
            "end": ("standing", "stop"),
            "halt": ("standing", "stop"),
        },
        "burst": {
            "move": ("starting", "replace"),
            "zero": ("standing", "stop"),
            "send": ("moving", "drive"),
            "wait": ("burst", ""),
            "end": ("standing", "stop"),
            "halt": ("standing", "stop"),
        },
        "moving": {
            "move": ("steering", "replace"),
            "zero": ("standing", "stop"),
            "send": ("moving", ""),
            "end": ("standing", "stop"),
            "halt": ("standing", "stop"),
        },
        "steering": {
            "move": ("steering", "replace"),
            "zero": ("standing", "stop"),
            "send": ("moving", "drive"),
            "end": ("standing", "stop"),
            "halt": ("standing", "stop"),
        },
    },
    impossible={
        ("standing", "wait"): _AFTER_THE_FIRST,
        ("passing", "wait"): _AFTER_THE_FIRST,
        ("moving", "wait"): _AFTER_THE_FIRST,
        ("steering", "wait"): _AFTER_THE_FIRST,
        ("starting", "hand_over"): _STOPPED_FIRST,
        ("burst", "hand_over"): _STOPPED_FIRST,
        ("moving", "hand_over"): _STOPPED_FIRST,
        ("steering", "hand_over"): _STOPPED_FIRST,
    },
)

_ROWS: Final = MOTION.rows
_FORGETTING: Final[frozenset[MotionAction]] = frozenset({"drop", "pass", "drive", "stop"})


class Motion:
    """Its state, the command that goes out next, and the times and counts of the motion."""

    def __init__(self) -> None:
        self.state: MotionState = "standing"
        self.pending: Command | None = None  # in the states from which "send" publishes
        self.accepted_ns = 0
        self._commands = 0
        self._is_by_hand = True  # no command had the time of its client

    @property
    def is_moving(self) -> bool:
        """Return whether a command to move has been accepted, and nothing has stopped it."""
        return self.state in MOVING

    def is_in_time(self, now_ns: int, deadline_ns: int) -> bool:
        """Return whether it is moving, and its deadline has not passed."""
        return self.state in MOVING and now_ns - self.accepted_ns < deadline_ns

    @property
    def is_single(self) -> bool:
        """Return whether it is a motion of one command, without its client's time."""
        return self._commands == 1 and self._is_by_hand

    @property
    def is_proved(self) -> bool:
        """Return whether its client's clock proves that what goes out next is fresh."""
        return self.pending is not None and self.pending.age == "fresh"

    def on(self, event: MotionEvent) -> MotionAction:
        """Go to the next state, and return the action."""
        self.state, action = _ROWS[self.state][event]
        if action in _FORGETTING:
            self.pending = None
        return action

    def keep(self, zero: Command) -> None:
        """Let a zero go out at the end of the turn."""
        self.pending = zero

    def move(self, command: Command, now_ns: int) -> Effects:
        """Accept a command to move, and return what watchers hear of it."""
        action = self.on("move")
        if action == "begin":
            self._commands = 0
            self._is_by_hand = True
        self.pending, self.accepted_ns = command, now_ns
        self._commands += 1
        self._is_by_hand &= command.age == "unknown"
        return [Changed()] if action == "begin" else []
