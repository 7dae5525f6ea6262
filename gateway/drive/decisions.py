# SPDX-License-Identifier: Apache-2.0
"""The two tables that connect the machines of a drive: each stop, and each command to move."""

from collections.abc import Mapping
from typing import Final, Literal

from gateway.drive.effects import Cause, GuardState
from gateway.drive.freshness import Age
from gateway.drive.motion import MotionEvent
from gateway.drive.trip_latch import LatchEvent, LatchState

BACKLOG_GAP_NS: Final = 3_000_000  # XR's 120 Hz are 8 ms apart

# Two reasons have a row for each case. A motion is single if it had one command, without its
# client's time.
Reason = (
    Cause
    | Literal[
        "late_zero",
        "own_stop",
        "single_deadline",
        "single_disconnect",
        "invalid_while_waiting",
        "reader_while_waiting",
    ]
)
# The cause that clients see, the event of the motion, and the event of the trip latch, if any.
STOPS: Final[Mapping[Reason, tuple[Cause, MotionEvent, LatchEvent | None]]] = {
    "zero": ("zero", "zero", None),
    "late_zero": ("zero", "end", None),
    "stop": ("stop", "halt", "trip"),
    "own_stop": ("stop", "halt", None),
    "release": ("release", "end", None),
    "deadline": ("deadline", "end", "trip"),
    "single_deadline": ("deadline", "end", "trip_single"),
    "disconnect": ("disconnect", "end", "trip"),
    "single_disconnect": ("disconnect", "end", "trip_single"),
    "takeover": ("takeover", "end", "trip"),
    "lease": ("lease", "end", "trip"),
    "permission": ("permission", "end", "trip"),
    "invalid_value": ("invalid_value", "end", "trip"),
    "invalid_while_waiting": ("invalid_value", "halt", "trip"),
    "backlog": ("backlog", "halt", "trip"),
    "guard": ("guard", "end", "trip"),
    "reader": ("reader", "end", "trip"),
    "reader_while_waiting": ("reader", "halt", "trip"),
    "shutdown": ("shutdown", "end", "trip"),
}

Decision = Literal["accept", "single", "unready", "refuse"]
DECISIONS: Final[Mapping[Decision, str]] = {
    "accept": "goes out at the end of the turn",
    "single": "waits for 250 ms to see whether it is alone, or is refused at once if it is not",
    "unready": "waits for the guard",
    "refuse": "is refused, and so is a command that waits",
}
# A command to move, by the latch and the guard. While the gateway shuts down, the guard counts as
# lost.
MOVES: Final[Mapping[LatchState, Mapping[GuardState, Decision]]] = {
    "open": {"starting": "unready", "prepared": "unready", "ready": "accept", "lost": "refuse"},
    "single": {"starting": "single", "prepared": "single", "ready": "single", "lost": "refuse"},
    "single_resetting": {
        "starting": "refuse",
        "prepared": "refuse",
        "ready": "refuse",
        "lost": "refuse",
    },
    "tripped": {
        "starting": "refuse",
        "prepared": "refuse",
        "ready": "refuse",
        "lost": "refuse",
    },
    "resetting": {
        "starting": "refuse",
        "prepared": "refuse",
        "ready": "refuse",
        "lost": "refuse",
    },
}


def is_alone(age: Age, gap_ns: int | None) -> bool:
    """Return whether a command may be a single one, *gap_ns* after the one before it.

    A client that sends its time needs no single command, and gets none.
    """
    return age == "unknown" and (gap_ns is None or gap_ns >= BACKLOG_GAP_NS)
