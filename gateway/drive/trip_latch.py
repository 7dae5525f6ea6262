# SPDX-License-Identifier: Apache-2.0
"""The trip latch: after a stop that the driver did not ask for, it keeps the robot stopped.

When a network is back, it delivers within milliseconds everything that was sent while it was dead:
commands to move, and among them commands to stop. The operator has let go long ago. So a command to
stop resets the latch only when `QUIET_NS` have passed after it without a command to move. In a
backlog the next one comes within milliseconds. An operator takes longer to let go and push again. A
command that its client's clock proves fresh resets it at once.
"""

from typing import Final, Literal

from gateway.drive.effects import Cause, Changed, Effects
from gateway.drive.table import StateTable

QUIET_NS: Final = 250_000_000

LatchState = Literal["open", "single", "single_resetting", "tripped", "resetting"]
LatchEvent = Literal[
    "trip", "trip_single", "first", "zero", "fresh_zero", "move", "quiet", "late", "go"
]
LatchAction = Literal["", "note", "first", "time", "again", "used", "reset", "clear"]

_ONLY_OPEN: Final = "a robot moves only while the latch is open"
_NO_RESET: Final = "no reset is under way"
_TAKEN_BACK: Final = "a command waits only in `open` and `single`"

LATCH: Final[StateTable[LatchState, LatchEvent, LatchAction]] = StateTable(
    "Trip latch",
    states={
        "open": "commands to move pass",
        "single": "refuses all but a single command, which waits for 250 ms",
        "single_resetting": "as `resetting`, but watchers see no safety stop",
        "tripped": "safety stop: refuses commands to move",
        "resetting": "a zero command came, 250 ms without a command to move must follow",
    },
    events={
        "trip": "a stop that the client did not ask for",
        "trip_single": "such a stop ends a motion of one command without its client's time",
        "first": "a new client commands to move, and by the rules must send zero first",
        "zero": "a zero command",
        "fresh_zero": "a zero command that its client's clock proves fresh",
        "move": "a command to move is refused, or another client gets control",
        "quiet": "250 ms have passed since the zero command",
        "late": "500 ms have passed: the gateway hung, and commands may wait",
        "go": "the command that waited goes out",
    },
    actions={
        "note": "note the cause, forget the zero command",
        "first": "note the cause `start`, watchers hear of it",
        "time": "count 250 ms from now",
        "again": "forget the zero command",
        "used": "forget the zero command, watchers hear of the safety stop",
        "reset": "forget the cause, watchers hear of it",
        "clear": "forget the cause",
    },
    rows={
        "open": {
            "trip": ("tripped", "note"),
            "trip_single": ("single", "note"),
            "first": ("tripped", "first"),
            "zero": ("open", ""),
            "fresh_zero": ("open", ""),
            "move": ("open", ""),
            "go": ("open", ""),
        },
        "single": {
            "trip": ("tripped", "note"),
            "first": ("single", ""),
            "zero": ("single_resetting", "time"),
            "fresh_zero": ("open", "reset"),
            "move": ("tripped", "used"),
            "go": ("open", "clear"),
        },
        "single_resetting": {
            "trip": ("tripped", "note"),
            "first": ("single_resetting", ""),
            "zero": ("single_resetting", ""),
            "fresh_zero": ("open", "reset"),
            "move": ("tripped", "used"),
            "quiet": ("open", "reset"),
            "late": ("single_resetting", "time"),
        },
        "tripped": {
            "trip": ("tripped", "note"),
            "first": ("tripped", ""),
            "zero": ("resetting", "time"),
            "fresh_zero": ("open", "reset"),
            "move": ("tripped", ""),
        },
        "resetting": {
            "trip": ("tripped", "note"),
            "first": ("resetting", ""),
            "zero": ("resetting", ""),
            "fresh_zero": ("open", "reset"),
            "move": ("tripped", "again"),
            "quiet": ("open", "reset"),
            "late": ("resetting", "time"),
        },
    },
    impossible={
        ("single", "trip_single"): _ONLY_OPEN,
        ("single_resetting", "trip_single"): _ONLY_OPEN,
        ("tripped", "trip_single"): _ONLY_OPEN,
        ("resetting", "trip_single"): _ONLY_OPEN,
        ("open", "quiet"): _NO_RESET,
        ("single", "quiet"): _NO_RESET,
        ("tripped", "quiet"): _NO_RESET,
        ("open", "late"): _NO_RESET,
        ("single", "late"): _NO_RESET,
        ("tripped", "late"): _NO_RESET,
        ("single_resetting", "go"): _TAKEN_BACK,
        ("tripped", "go"): _TAKEN_BACK,
        ("resetting", "go"): _TAKEN_BACK,
    },
)

_ROWS: Final = LATCH.rows
_NOTING: Final[frozenset[LatchAction]] = frozenset({"note", "first"})
_TELLING: Final[frozenset[LatchAction]] = frozenset({"first", "used", "reset"})
_TRIPPED: Final[frozenset[LatchState]] = frozenset({"tripped", "resetting"})


class TripLatch:
    """Its state, the cause, and the time of a reset that is under way."""

    def __init__(self) -> None:
        self.state: LatchState = "open"
        self.cause: Cause | None = None  # while it is not open
        self.due_ns: int | None = None  # when the reset is over that is under way

    @property
    def is_tripped(self) -> bool:
        """Return whether watchers see a safety stop."""
        return self.state in _TRIPPED

    def on(self, event: LatchEvent, cause: Cause | None = None, now_ns: int = 0) -> Effects:
        """Go to the next state, and return what watchers hear of it."""
        self.state, action = _ROWS[self.state][event]
        if not action:
            return []
        self.due_ns = now_ns + QUIET_NS if action == "time" else None
        if action in _NOTING:
            self.cause = cause
        elif self.state == "open":
            self.cause = None
        return [Changed()] if action in _TELLING else []

    def tick(self, now_ns: int) -> Effects:
        """End the reset, if it is over."""
        due_ns = self.due_ns
        if due_ns is None or now_ns < due_ns:
            return []
        # So late only if the gateway stood still: commands may wait that came in this time.
        return self.on("late" if now_ns - due_ns >= QUIET_NS else "quiet", None, now_ns)
